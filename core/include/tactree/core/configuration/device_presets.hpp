#pragma once
// Presets of known devices. Lengths, ratios, counts, torque constants and forces are published
// values unless marked "estimate". Masses, centres of mass, inertias, friction and joint ranges are
// estimates for the class of device; measure those of your device.
//
// Interrupt safety: constants and pure functions.
// Loop and memory annotations: docs/BOUND.md.

#include "tactree/core/configuration/configuration.hpp"
#include "tactree/core/device/device_model.hpp"
#include "tactree/core/math/angle.hpp"

namespace tactree::core {

/// Limits of the motors, and the damping for the stability limit.
struct DeviceDrive {
  float force_max_N = 8.0F;                      ///< at the probe
  float effort_max[kAxes] = {8.5F, 8.5F, 8.5F};  ///< N or Nm at the joints
  float damping_Ns_m = 0.05F;                    ///< minimum viscous damping at the probe
};

/// Dynamics for simulation. Units of a linear axis: kg, Ns/m, N; of a joint: kg m2, Nms, Nm.
struct DeviceDynamics {
  float inertia[kAxes] = {0.075F, 0.075F, 0.075F};  ///< links and motor, without the tip's mass
  float viscous[kAxes] = {0.05F, 0.05F, 0.05F};
  float coulomb[kAxes] = {0.04F, 0.04F, 0.04F};  ///< dry friction
};

struct DevicePreset {
  const char* name = "";
  const char* about = "";
  DeviceModel model{};
  DeviceDrive drive{};
  DeviceDynamics dynamics{};
};

namespace presets {

template <class T>
constexpr void set(T (&to)[kAxes], T x, T y, T z) {
  to[0] = x;
  to[1] = y;
  to[2] = z;
}

constexpr DevicePreset cartesian() {
  DevicePreset p;
  p.name = "cartesian";
  p.about = "three linear axes: the textbook case";
  p.model.homing = HomingMethod::kAbsolute;
  set(p.model.joint_min, -0.5F, -0.5F, -0.5F);
  set(p.model.joint_max, 0.5F, 0.5F, 0.5F);
  set(p.model.joint_margin, 0.01F, 0.01F, 0.01F);
  return p;
}

/// Home: arm horizontal, forearm hanging; the probe is then at the origin.
constexpr DevicePreset premium() {
  DevicePreset p;
  p.name = "premium";
  p.about = "PHANTOM Premium 1.5 class: serial 3R with a parallelogram";
  DeviceModel& m = p.model;
  m.kind = DeviceKind::kArm;
  m.homing = HomingMethod::kGivenPose;
  m.arm = {0.20955F, 0.169545F, 0.0F};  // the crank of the parallelogram, 0.03175 m, cancels out
  set(m.ratio, 13.3F, 11.2F, 11.2F);
  set(m.counts_per_revolution, 4096.0F, 4096.0F, 4096.0F);  // 1024 lines
  set(m.joint_min, -1.1F, -0.75F, -0.9F);
  set(m.joint_max, 1.1F, 1.3F, 1.1F);
  set(m.joint_margin, 0.08F, 0.08F, 0.08F);
  m.origin_m = {0.20955F, 0.0F, -0.169545F};
  // The motors are mounted behind the joints and balance most of the weight.
  set(m.link_mass_kg, 0.0F, 0.30F, 0.045F);
  set(m.link_centre_m, 0.0F, -0.040F, -0.060F);
  m.tip_mass_kg = 0.030F;
  set(m.torque_constant_Nm_per_ampere, 0.0235F, 0.0235F, 0.0235F);  // estimate: 20 W brushed motors
  p.drive = {8.5F, {1.9F, 1.8F, 1.5F}, 0.0125F};  // efforts: estimate, 8.5 N at home
  // These give the manufacturer's values for the class, 0.075 kg and 0.04 N at the probe at home.
  p.dynamics = {
      {2.0e-3F, 2.0e-3F, 1.3e-3F}, {5.5e-4F, 5.5e-4F, 3.6e-4F}, {8.4e-3F, 8.4e-3F, 6.8e-3F}};
  return p;
}

/// Home: arm vertical, forearm horizontal. The shoulder is 0.080 m above the table, the origin
/// 0.285 m.
constexpr DevicePreset wooden() {
  DevicePreset p;
  p.name = "wooden";
  p.about = "WoodenHaptics class: serial 3R, cable drives";
  DeviceModel& m = p.model;
  m.kind = DeviceKind::kArm;
  m.homing = HomingMethod::kGivenPose;
  m.arm = {0.205F, 0.245F, 1.0F};
  set(m.ratio, 160.0F / 10.0F, 120.0F / 10.0F, 120.0F / 10.0F);
  set(m.counts_per_revolution, 2000.0F, 2000.0F, 2000.0F);
  set(m.home_position, 0.0F, kQuarterTurn, 0.0F);
  set(m.joint_min, -1.0F, 0.7F, -0.9F);
  set(m.joint_max, 1.0F, 2.4F, 0.9F);
  set(m.joint_margin, 0.08F, 0.08F, 0.08F);
  m.origin_m = {0.245F, 0.0F, 0.205F};
  set(m.link_mass_kg, 0.0F, 0.30F, 0.12F);
  set(m.link_centre_m, 0.0F, 0.08F, 0.09F);
  m.tip_mass_kg = 0.05F;
  set(m.torque_constant_Nm_per_ampere, 0.0259F, 0.0259F, 0.0259F);
  p.drive = {6.0F, {1.5F, 1.4F, 1.4F}, 0.05F};  // estimate: 4 A per motor
  p.dynamics = {
      {6.0e-3F, 5.0e-3F, 3.0e-3F}, {3.0e-3F, 2.5e-3F, 3.0e-3F}, {2.5e-2F, 2.0e-2F, 2.0e-2F}};
  return p;
}

/// Home: arms at 46 degrees (estimate). The origin is 0.125 m in front of the ring.
constexpr DevicePreset falcon() {
  DevicePreset p;
  p.name = "falcon";
  p.about = "Novint Falcon class: delta";
  DeviceModel& m = p.model;
  m.kind = DeviceKind::kDelta;
  m.homing = HomingMethod::kIndex;
  m.delta = {0.060F,   0.1025F,   0.01443F,
             0.01125F, 0.01125F,  -0.025F,
             0.040F,   -0.02309F, {105.0F * kDegree, -15.0F * kDegree, -135.0F * kDegree}};
  // 9881 counts per joint revolution; the split into counts and ratio is an estimate.
  set(m.counts_per_revolution, 1280.0F, 1280.0F, 1280.0F);
  set(m.ratio, 9881.0F / 1280.0F, 9881.0F / 1280.0F, 9881.0F / 1280.0F);
  set(m.home_position, 46.0F * kDegree, 46.0F * kDegree, 46.0F * kDegree);
  set(m.joint_min, -0.65F, -0.65F, -0.65F);
  set(m.joint_max, 1.50F, 1.50F, 1.50F);
  set(m.joint_margin, 0.06F, 0.06F, 0.06F);
  m.origin_m = {0.125F, 0.0F, 0.0F};
  set(m.link_mass_kg, 0.03F, 0.03F, 0.03F);
  set(m.link_centre_m, 0.03F, 0.03F, 0.03F);
  m.tip_mass_kg = 0.10F;
  set(m.torque_constant_Nm_per_ampere, 0.027F, 0.027F, 0.027F);  // estimate
  p.drive = {8.0F, {0.40F, 0.40F, 0.40F}, 0.3F};                 // efforts: estimate
  p.dynamics = {
      {2.0e-4F, 2.0e-4F, 2.0e-4F}, {1.0e-3F, 1.0e-3F, 1.0e-3F}, {8.0e-3F, 8.0e-3F, 8.0e-3F}};
  return p;
}

/// Home: both arms horizontal, pointing outwards. The origin is 0.0887 m above the motors.
constexpr DevicePreset pantograph() {
  DevicePreset p;
  p.name = "pantograph";
  p.about = "Haply 2DIY class: five-bar, two axes in an upright plane";
  DeviceModel& m = p.model;
  m.kind = DeviceKind::kFiveBar;
  m.homing = HomingMethod::kHardStop;
  m.five_bar = {0.05F, 0.07F, 0.02F};
  set(m.counts_per_revolution, 4880.0F, 4880.0F, 4880.0F);  // estimate; direct drive
  set(m.home_position, 180.0F * kDegree, 0.0F, 0.0F);
  set(m.joint_min, 85.0F * kDegree, -20.0F * kDegree, -1.0F);
  set(m.joint_max, 200.0F * kDegree, 95.0F * kDegree, 1.0F);
  set(m.joint_margin, 0.08F, 0.08F, 0.08F);
  m.origin_m = {0.0F, 0.0F, 0.0887F};
  set(m.link_mass_kg, 0.015F, 0.015F, 0.0F);
  set(m.link_centre_m, 0.03F, 0.03F, 0.0F);
  m.tip_mass_kg = 0.02F;
  set(m.torque_constant_Nm_per_ampere, 0.05F, 0.05F, 0.05F);  // estimate
  p.drive = {3.0F, {0.20F, 0.20F, 0.20F}, 0.04F};             // estimate
  p.dynamics = {
      {5.0e-5F, 5.0e-5F, 5.0e-5F}, {1.0e-4F, 1.0e-4F, 1.0e-4F}, {2.0e-3F, 2.0e-3F, 2.0e-3F}};
  return p;
}

/// Home: paddle horizontal; the probe is then at the origin.
constexpr DevicePreset hapkit() {
  DevicePreset p;
  p.name = "hapkit";
  p.about = "Hapkit class: one capstan-driven paddle";
  DeviceModel& m = p.model;
  m.kind = DeviceKind::kPaddle;
  m.homing = HomingMethod::kGivenPose;
  m.paddle_m = 0.070F;
  set(m.ratio, 75.0F / 5.75F, 1.0F, 1.0F);                  // radius of the sector / of the pulley
  set(m.counts_per_revolution, 2048.0F, 2048.0F, 2048.0F);  // estimate
  set(m.joint_min, -0.65F, -1.0F, -1.0F);
  set(m.joint_max, 0.65F, 1.0F, 1.0F);
  set(m.joint_margin, 0.05F, 0.05F, 0.05F);
  m.origin_m = {0.070F, 0.0F, 0.0F};
  set(m.link_mass_kg, 0.03F, 0.0F, 0.0F);
  set(m.link_centre_m, 0.02F, 0.0F, 0.0F);
  m.tip_mass_kg = 0.01F;
  set(m.torque_constant_Nm_per_ampere, 0.0185F, 0.0185F, 0.0185F);  // estimate
  p.drive = {5.0F, {0.40F, 0.40F, 0.40F}, 0.1F};                    // estimate
  p.dynamics = {
      {2.0e-4F, 2.0e-4F, 2.0e-4F}, {5.0e-4F, 5.0e-4F, 5.0e-4F}, {5.0e-3F, 5.0e-3F, 5.0e-3F}};
  return p;
}

}  // namespace presets

inline constexpr DevicePreset kDevicePresets[] = {presets::cartesian(),  presets::premium(),
                                                  presets::wooden(),     presets::falcon(),
                                                  presets::pantograph(), presets::hapkit()};

/// Copies a device to the configuration: model, limits of force, effort and effort slew, damping.
constexpr void use_device(const DevicePreset& device, Configuration& configuration) {
  // Time from zero to full effort of an axis. The defaults of Configuration give about the same.
  constexpr float kFullEffortIn_s = 0.004F;
  configuration.device = device.model;
  configuration.limits.force_max_N = device.drive.force_max_N;
  configuration.device_damping_Ns_m = device.drive.damping_Ns_m;
  for (std::uint32_t i = 0; i < kAxes; ++i) {  // bound: kAxes
    configuration.motors.effort_max[i] = device.drive.effort_max[i];
    configuration.motors.effort_slew_s[i] = device.drive.effort_max[i] / kFullEffortIn_s;
  }
}

}  // namespace tactree::core
