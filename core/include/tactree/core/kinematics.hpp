#pragma once
// From encoder counts to the probe, and from a force at the probe to the effort of each axis.
// Interrupt safe: pure functions.

#include <cstdint>

#include "tactree/core/device_model.hpp"
#include "tactree/core/vec3.hpp"

namespace tactree::core {

/// Three rows.
struct Mat3 {
  Vec3 row[3]{};
  friend constexpr Vec3 operator*(const Mat3& m, Vec3 v) {
    return {dot(m.row[0], v), dot(m.row[1], v), dot(m.row[2], v)};
  }
};

/// The vector times the matrix: v.x of row 0, and so on.
constexpr Vec3 transposed_times(const Mat3& m, Vec3 v) {
  return v.x * m.row[0] + v.y * m.row[1] + v.z * m.row[2];
}

/// Where the device is.
struct DevicePose {
  bool valid = false;  ///< finite, within the joints' ranges, and a place that the device can be
  /// Share of the force that may be displayed here: 1, falling to 0 at the end of a joint's range
  /// and near a singular pose.
  float reach = 0.0F;
  Vec3 joints{};  ///< m or rad; 0 of an unused axis
  Vec3 probe{};   ///< m, device frame
  /// J transposed: efforts of the axes (N or Nm) for a force at the probe. The rows are the
  /// probe's motion per motion of each axis; 0 of an unused axis.
  Mat3 effort_per_force{};
  Vec3 gravity_effort{};  ///< N or Nm: efforts that hold the device's own weight
};

/// Counters may wrap around: only their difference from home counts.
/// Precondition: is_valid(device). Probe and Jacobian are as the float32 of exact arithmetic but
/// for 1e-6 of the device's size; kDelta by a closed form and three steps of Newton, the others in
/// closed form. Cost: constant; kDelta, the dearest, about 700 operations.
[[nodiscard]] DevicePose locate(const DeviceModel& device, const std::int32_t (&counts)[kAxes]);

/// The same from joint positions; of unused axes they do not matter.
[[nodiscard]] DevicePose locate_joints(const DeviceModel& device, Vec3 joints);

/// Joint positions that the counters tell. Precondition: is_valid(device). 0 of an unused axis.
[[nodiscard]] Vec3 joints_of(const DeviceModel& device, const std::int32_t (&counts)[kAxes]);

}  // namespace tactree::core
