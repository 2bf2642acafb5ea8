#include "tactree/core/kinematics.hpp"

namespace tactree::core {
namespace {

constexpr Mat3 kIdentity{{{1.0F, 0.0F, 0.0F}, {0.0F, 1.0F, 0.0F}, {0.0F, 0.0F, 1.0F}}};

/// Travel of one axis, as if the counter had no end.
float travel(const DeviceModel& device, std::uint32_t axis, std::int32_t count) {
  const std::uint32_t difference =
      static_cast<std::uint32_t>(count) - static_cast<std::uint32_t>(device.home_count[axis]);
  return static_cast<float>(static_cast<std::int32_t>(difference)) / device.counts_per_m[axis];
}

DevicePose locate_cartesian(const DeviceModel& device, const std::int32_t (&counts)[kAxes]) {
  const Vec3 probe = {travel(device, 0, counts[0]), travel(device, 1, counts[1]),
                      travel(device, 2, counts[2])};
  return {is_finite(probe), probe, kIdentity};
}

}  // namespace

bool is_valid(const DeviceModel& device) {
  if (device.kind != DeviceKind::kCartesian) {
    return false;
  }
  bool valid = true;
  for (const float counts : device.counts_per_m) {  // bound: kAxes
    valid = valid && counts >= 1.0F && counts <= 1e9F;
  }
  return valid;
}

DevicePose locate(const DeviceModel& device, const std::int32_t (&counts)[kAxes]) {
  if (device.kind == DeviceKind::kCartesian) {
    return locate_cartesian(device, counts);
  }
  return {};
}

}  // namespace tactree::core
