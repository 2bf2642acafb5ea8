#pragma once
// Kinematics: conversion of encoder counts to the probe position, and of a force at the probe to
// the effort of each axis.
//
// Interrupt safety: pure functions.
// Loop and memory annotations: docs/BOUND.md.
// memory: RAM

#include <cstdint>

#include "tactree/core/device/device_model.hpp"
#include "tactree/core/math/vec3.hpp"

namespace tactree::core {

/// 3 x 3 matrix, stored by rows.
struct Mat3 {
  Vec3 row[3]{};
  friend constexpr Vec3 operator*(const Mat3& m, Vec3 v) {
    return {dot(m.row[0], v), dot(m.row[1], v), dot(m.row[2], v)};
  }
};

/// Transposed matrix times vector: v.x * row 0 + v.y * row 1 + v.z * row 2.
constexpr Vec3 transposed_times(const Mat3& m, Vec3 v) {
  return v.x * m.row[0] + v.y * m.row[1] + v.z * m.row[2];
}

/// Force at the probe per effort of one axis, N per N or Nm: row i is that of axis i while the hand
/// holds the probe still. `effort_per_force`: the transposed Jacobian, of which this is the
/// inverse. Unused axes, rows of zeros at the end, have no force; for fewer than three axes it is
/// the force in the line or plane of the others. Not finite in a singular pose. Cost: constant,
/// about 50 operations.
[[nodiscard]] Mat3 force_per_effort(const Mat3& effort_per_force);

/// Pose of the device.
struct DevicePose {
  bool valid = false;  ///< finite, within the joints' ranges, and reachable
  /// Fraction of the force that may be rendered: 1, falling to 0 at the end of a joint's range and
  /// near a singular pose.
  float reach = 0.0F;
  Vec3 joints{};  ///< m or rad; 0 for an unused axis
  Vec3 probe{};   ///< m, device frame
  /// Transposed Jacobian: efforts of the axes (N or Nm) for a force at the probe. Row i is the
  /// velocity of the probe per velocity of axis i; 0 for an unused axis.
  Mat3 effort_per_force{};
  Vec3 gravity_effort{};  ///< N or Nm: efforts that balance the device's weight
};

/// Pose from encoder counts. Counters may wrap around. Precondition: is_valid(device).
/// Error of probe and Jacobian: at most 1e-6 of the device's size. kDelta uses a closed form and
/// three Newton steps, the other kinds a closed form. Cost: constant, at most about 700 operations
/// (kDelta).
[[nodiscard]] DevicePose locate(const DeviceModel& device, const std::int32_t (&counts)[kAxes]);

/// Pose from joint positions. The components of unused axes are ignored.
[[nodiscard]] DevicePose locate_joints(const DeviceModel& device, Vec3 joints);

/// Joint positions from encoder counts; 0 for an unused axis. Precondition: is_valid(device).
[[nodiscard]] Vec3 joints_of(const DeviceModel& device, const std::int32_t (&counts)[kAxes]);

}  // namespace tactree::core
