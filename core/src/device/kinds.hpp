#pragma once
// Forward kinematics of each kind of device: probe, Jacobian, distance from singular poses, and the
// weight of the links.

#include "tactree/core/device/kinematics.hpp"

namespace tactree::core {

inline constexpr float kGravity = 9.80665F;  // m/s2

/// A pose in the frame of the geometry.
struct KindPose {
  bool valid = false;
  Vec3 probe{};
  Mat3 effort_per_force{};
  Vec3 link_effort{};  ///< supports the weight of the links, without the tip mass
  /// Normalised distance from singular poses, at most 1; 0 or less in a singular pose. Each kind
  /// has its own measure.
  float openness = 1.0F;
};

[[nodiscard]] KindPose locate_arm(const DeviceModel& device, Vec3 joints);
[[nodiscard]] KindPose locate_delta(const DeviceModel& device, Vec3 joints);
[[nodiscard]] KindPose locate_five_bar(const DeviceModel& device, Vec3 joints);
[[nodiscard]] KindPose locate_paddle(const DeviceModel& device, Vec3 joints);

}  // namespace tactree::core
