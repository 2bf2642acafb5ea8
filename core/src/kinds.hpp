#pragma once
// What each kind of device knows: probe, Jacobian, distance from singular poses, its links' weight.

#include "tactree/core/kinematics.hpp"

namespace tactree::core {

inline constexpr float kGravity = 9.80665F;  // m/s2

/// A pose in the frame of the geometry.
struct KindPose {
  bool valid = false;
  Vec3 probe{};
  Mat3 effort_per_force{};
  Vec3 link_effort{};  ///< holds the links, without what moves with the probe
  /// How far from singular, 0 .. 1: the sine of the worst angle that must not close.
  float openness = 1.0F;
};

[[nodiscard]] KindPose locate_arm(const DeviceModel& device, Vec3 joints);
[[nodiscard]] KindPose locate_delta(const DeviceModel& device, Vec3 joints);
[[nodiscard]] KindPose locate_five_bar(const DeviceModel& device, Vec3 joints);
[[nodiscard]] KindPose locate_paddle(const DeviceModel& device, Vec3 joints);

}  // namespace tactree::core
