#pragma once
// From encoder counts to the probe, and from a force at the probe to the effort of each axis.
// Interrupt safe: pure functions.

#include <cstdint>

#include "tactree/core/vec3.hpp"

namespace tactree::core {

inline constexpr std::uint32_t kAxes = 3;

/// Three rows.
struct Mat3 {
  Vec3 row[3]{};
  friend constexpr Vec3 operator*(const Mat3& m, Vec3 v) {
    return {dot(m.row[0], v), dot(m.row[1], v), dot(m.row[2], v)};
  }
};

enum class DeviceKind : std::uint8_t {
  kCartesian = 0,  ///< three linear axes along x, y and z
};

/// A device. Which members count depends on `kind`.
struct DeviceModel {
  DeviceKind kind = DeviceKind::kCartesian;
  /// Encoder counts per metre of travel (cartesian): 1 .. 1e9.
  float counts_per_m[kAxes] = {33333.3F, 33333.3F, 33333.3F};
  /// Count at which an axis is at 0 m.
  std::int32_t home_count[kAxes] = {0, 0, 0};
};

/// Where the device is.
struct DevicePose {
  bool valid = false;  ///< finite, and reachable by the device
  Vec3 probe{};        ///< m, device frame
  Mat3
      effort_per_force{};  ///< J transposed: efforts of the axes (N or Nm) for a force at the probe
};

/// Is every figure of the model finite and within its range?
[[nodiscard]] bool is_valid(const DeviceModel& device);

/// Counters may wrap around: only their difference from home counts.
/// Precondition: is_valid(device). Cost: constant.
[[nodiscard]] DevicePose locate(const DeviceModel& device, const std::int32_t (&counts)[kAxes]);

}  // namespace tactree::core
