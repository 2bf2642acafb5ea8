// Range checks of the device parameters.
// Loop and memory annotations: docs/BOUND.md.

#include "tactree/core/device/device_model.hpp"

#include "tactree/core/math/angle.hpp"

namespace tactree::core {
namespace {

constexpr bool in_range(float value, float low, float high) {
  return value >= low && value <= high;
}

bool is_valid(const ArmGeometry& g) {
  return in_range(g.arm_m, 0.01F, 10.0F) && in_range(g.forearm_m, 0.01F, 10.0F) &&
         in_range(g.coupling, 0.0F, 1.0F);
}

bool is_valid(const DeltaGeometry& g) {
  bool valid = in_range(g.a, 1e-3F, 1.0F) && in_range(g.b, 1e-3F, 1.0F);
  valid = valid && in_range(g.c, -1.0F, 1.0F) && in_range(g.d, 0.0F, 1.0F) &&
          in_range(g.e, 0.0F, 1.0F) && in_range(g.f, -1.0F, 1.0F) && in_range(g.r, -1.0F, 1.0F) &&
          in_range(g.s, -1.0F, 1.0F);
  for (const float place : g.leg_rad) {  // bound: kAxes
    valid = valid && in_range(place, -kTwoPi, kTwoPi);
  }
  return valid;
}

bool is_valid(const FiveBarGeometry& g) {
  return in_range(g.arm_m, 1e-3F, 10.0F) && in_range(g.forearm_m, 1e-3F, 10.0F) &&
         in_range(g.base_m, 0.0F, 10.0F);
}

bool is_valid_geometry(const DeviceModel& device) {
  if (device.kind == DeviceKind::kArm) {
    return is_valid(device.arm);
  }
  if (device.kind == DeviceKind::kDelta) {
    return is_valid(device.delta);
  }
  if (device.kind == DeviceKind::kFiveBar) {
    return is_valid(device.five_bar);
  }
  return device.kind != DeviceKind::kPaddle || in_range(device.paddle_m, 1e-3F, 10.0F);
}

bool is_valid_axis(const DeviceModel& d, std::uint32_t i) {
  const bool linear = d.kind == DeviceKind::kCartesian;
  const float furthest = linear ? 1e12F : 100.0F;
  const bool counts = linear ? in_range(d.counts_per_m[i], 1.0F, 1e9F)
                             : in_range(d.counts_per_revolution[i], 1.0F, 1e7F);
  const bool range = in_range(d.joint_min[i], -furthest, furthest) &&
                     in_range(d.joint_max[i], -furthest, furthest) &&
                     d.joint_min[i] < d.joint_max[i] &&
                     in_range(d.home_position[i], d.joint_min[i], d.joint_max[i]) &&
                     in_range(d.joint_margin[i], 0.0F, 0.5F * (d.joint_max[i] - d.joint_min[i]));
  const bool motor = in_range(d.ratio[i] < 0.0F ? -d.ratio[i] : d.ratio[i], 1e-3F, 1e5F) &&
                     in_range(d.torque_constant_Nm_per_ampere[i], 1e-6F, 1e3F);
  const bool masses =
      in_range(d.link_mass_kg[i], 0.0F, 100.0F) && in_range(d.link_centre_m[i], -10.0F, 10.0F);
  return counts && range && motor && masses;
}

}  // namespace

bool is_valid(const DeviceModel& device) {
  if (static_cast<std::uint32_t>(device.kind) >= kDeviceKinds ||
      static_cast<std::uint32_t>(device.homing) >= kHomingMethods) {
    return false;
  }
  bool valid = is_valid_geometry(device) && in_range(device.tip_mass_kg, 0.0F, 100.0F) &&
               in_range(device.origin_m.x, -10.0F, 10.0F) &&
               in_range(device.origin_m.y, -10.0F, 10.0F) &&
               in_range(device.origin_m.z, -10.0F, 10.0F);
  const std::uint32_t axes = axes_of(device.kind);
  for (std::uint32_t i = 0; i < axes; ++i) {  // bound: kAxes
    valid = valid && is_valid_axis(device, i);
  }
  return valid;
}

}  // namespace tactree::core
