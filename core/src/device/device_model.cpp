// Range checks of the device parameters.
// Loop and memory annotations: docs/BOUND.md.

#include "tactree/core/device/device_model.hpp"

#include "tactree/core/math/angle.hpp"

namespace tactree::core {
namespace {

/// Keeps the first value that is out of range.
class Checks {
 public:
  void range(const char* field, float value, float min, float max) {
    refuse(!(value >= min && value <= max), {field, value, min, max});
  }
  void refuse(bool refused, const DeviceRefusal& refusal) {
    if (passed() && refused) {
      first_ = refusal;
      first_.axis = axis_;
    }
  }
  /// The next values are those of this axis.
  void of_axis(std::uint32_t axis) { axis_ = static_cast<std::int32_t>(axis); }
  [[nodiscard]] bool passed() const { return first_.field == nullptr; }
  [[nodiscard]] const DeviceRefusal& first() const { return first_; }

 private:
  DeviceRefusal first_{};
  std::int32_t axis_ = -1;
};

void check_arm(const ArmGeometry& g, Checks& checks) {
  checks.range("device.arm.arm_m", g.arm_m, 0.01F, 10.0F);
  checks.range("device.arm.forearm_m", g.forearm_m, 0.01F, 10.0F);
  checks.range("device.arm.coupling", g.coupling, 0.0F, 1.0F);
}

void check_delta(const DeltaGeometry& g, Checks& checks) {
  checks.range("device.delta.a", g.a, 1e-3F, 1.0F);
  checks.range("device.delta.b", g.b, 1e-3F, 1.0F);
  checks.range("device.delta.c", g.c, -1.0F, 1.0F);
  checks.range("device.delta.d", g.d, 0.0F, 1.0F);
  checks.range("device.delta.e", g.e, 0.0F, 1.0F);
  checks.range("device.delta.f", g.f, -1.0F, 1.0F);
  checks.range("device.delta.r", g.r, -1.0F, 1.0F);
  checks.range("device.delta.s", g.s, -1.0F, 1.0F);
}

void check_five_bar(const FiveBarGeometry& g, Checks& checks) {
  checks.range("device.five_bar.arm_m", g.arm_m, 1e-3F, 10.0F);
  checks.range("device.five_bar.forearm_m", g.forearm_m, 1e-3F, 10.0F);
  checks.range("device.five_bar.base_m", g.base_m, 0.0F, 10.0F);
}

void check_geometry(const DeviceModel& device, Checks& checks) {
  if (device.kind == DeviceKind::kArm) {
    check_arm(device.arm, checks);
  } else if (device.kind == DeviceKind::kDelta) {
    check_delta(device.delta, checks);
  } else if (device.kind == DeviceKind::kFiveBar) {
    check_five_bar(device.five_bar, checks);
  } else if (device.kind == DeviceKind::kPaddle) {
    checks.range("device.paddle_m", device.paddle_m, 1e-3F, 10.0F);
  }
  checks.range("device.origin_m.x", device.origin_m.x, -10.0F, 10.0F);
  checks.range("device.origin_m.y", device.origin_m.y, -10.0F, 10.0F);
  checks.range("device.origin_m.z", device.origin_m.z, -10.0F, 10.0F);
  checks.range("device.tip_mass_kg", device.tip_mass_kg, 0.0F, 100.0F);
}

/// The joint's range, what lies in it, and the encoder that measures it.
void check_joint(const DeviceModel& d, std::uint32_t i, Checks& checks) {
  const bool linear = d.kind == DeviceKind::kCartesian;
  const float furthest = linear ? 1e12F : 100.0F;
  if (linear) {
    checks.range("device.counts_per_m", d.counts_per_m[i], 1.0F, 1e9F);
  } else {
    checks.range("device.counts_per_revolution", d.counts_per_revolution[i], 1.0F, 1e7F);
  }
  checks.range("device.joint_min", d.joint_min[i], -furthest, furthest);
  checks.range("device.joint_max", d.joint_max[i], d.joint_min[i], furthest);
  checks.refuse(!(d.joint_min[i] < d.joint_max[i]),
                {"device.joint_max", d.joint_max[i], d.joint_min[i], furthest});
  checks.range("device.home_position", d.home_position[i], d.joint_min[i], d.joint_max[i]);
  checks.range("device.joint_margin", d.joint_margin[i], 0.0F,
               0.5F * (d.joint_max[i] - d.joint_min[i]));
}

/// The motor, and what it moves.
void check_links(const DeviceModel& d, std::uint32_t i, Checks& checks) {
  checks.range("device.ratio", d.ratio[i] < 0.0F ? -d.ratio[i] : d.ratio[i], 1e-3F, 1e5F);
  checks.range("device.torque_constant_Nm_per_ampere", d.torque_constant_Nm_per_ampere[i], 1e-6F,
               1e3F);
  if (d.kind == DeviceKind::kDelta) {
    checks.range("device.delta.leg_rad", d.delta.leg_rad[i], -kTwoPi, kTwoPi);
  }
  checks.range("device.link_mass_kg", d.link_mass_kg[i], 0.0F, 100.0F);
  checks.range("device.link_centre_m", d.link_centre_m[i], -10.0F, 10.0F);
}

}  // namespace

DeviceRefusal refusal_of(const DeviceModel& device) {
  Checks checks;
  checks.range("device.kind", static_cast<float>(device.kind), 0.0F,
               static_cast<float>(kDeviceKinds - 1U));
  checks.range("device.homing", static_cast<float>(device.homing), 0.0F,
               static_cast<float>(kHomingMethods - 1U));
  if (!checks.passed()) {  // the others depend on the kind
    return checks.first();
  }
  check_geometry(device, checks);
  const std::uint32_t axes = axes_of(device.kind);
  for (std::uint32_t i = 0; i < axes; ++i) {  // bound: kAxes
    checks.of_axis(i);
    check_joint(device, i, checks);
    check_links(device, i, checks);
  }
  return checks.first();
}

}  // namespace tactree::core
