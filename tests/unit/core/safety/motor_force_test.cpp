// force_max_N limits the force at the probe of everything that the motors are told.

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>

#include "motor_signs.hpp"
#include "open_gate.hpp"
#include "tactree/core/configuration/device_presets.hpp"

namespace tactree::test {
namespace {

using core::Mat3;
using core::SafetyGate;
using core::Vec3;

bool is_limited(const SafetyGate::Result& result) {
  return (result.limits & core::limit_bit(core::Limit::kForce)) != 0U;
}

TEST(ForcePerEffort, InvertsJacobianOfEveryDevice) {
  for (const core::DevicePreset& preset : core::kDevicePresets) {
    const core::DevicePose pose = core::locate(preset.model, {10, -20, 15});
    ASSERT_TRUE(pose.valid) << preset.name;
    const Mat3 inverse = core::force_per_effort(pose.effort_per_force);
    const Vec3 efforts = pose.effort_per_force * Vec3{1.0F, -2.0F, 3.0F};
    const Vec3 again = pose.effort_per_force * core::transposed_times(inverse, efforts);
    EXPECT_LE(core::length(again - efforts), 1e-5F * core::length(efforts)) << preset.name;
    for (std::uint32_t axis = core::axes_of(preset.model.kind); axis < core::kAxes; ++axis) {
      EXPECT_EQ(inverse.row[axis], Vec3{}) << preset.name;
    }
  }
}

/// Largest forces of the motors, as shares of the limit.
struct Largest {
  double share = 0.0;
  double singular_share = 0.0;  ///< next to a singular pose or at the end of a range: reach is 0
};

/// Random forces and weights in random poses, over the ranges of all joints of one device.
Largest largest_shares(const core::DevicePreset& preset, float force_max_N, bool signs_proven) {
  core::Configuration configuration;
  core::use_device(preset, configuration);
  core::limit_force(configuration, force_max_N);
  configuration.limits.ramp_s = 0.002F;
  configuration.motors.signs_proven = signs_proven;
  SafetyGate gate;
  EXPECT_TRUE(gate.configure(core::gate_limits(configuration)));
  std::mt19937 random(5);
  std::uniform_real_distribution<float> unit(-1.0F, 1.0F);
  Largest largest;
  for (int i = 0; i < 20'000; ++i) {
    float joints[core::kAxes];
    for (std::uint32_t axis = 0; axis < core::kAxes; ++axis) {
      const float middle = 0.5F * (preset.model.joint_min[axis] + preset.model.joint_max[axis]);
      joints[axis] = middle + unit(random) * (preset.model.joint_max[axis] - middle);
    }
    const core::DevicePose pose =
        core::locate_joints(preset.model, {joints[0], joints[1], joints[2]});
    if (!pose.valid) {
      continue;
    }
    const Vec3 force = 20.0F * Vec3{unit(random), unit(random), unit(random)};
    const SafetyGate::Result result =
        gate.command(force, pose.effort_per_force, 3.0F * pose.gravity_effort);
    const double shown = signs_proven ? probe_force(pose, result.command, 0U)
                                      : largest_probe_force(pose, result.command);
    double& of_kind = pose.reach > 0.0F ? largest.share : largest.singular_share;
    of_kind = std::max(of_kind, shown / static_cast<double>(force_max_N));
  }
  return largest;
}

// Next to a singular pose the rounding of its matrix is no longer small.
void expect_within_limit(const Largest& largest) {
  EXPECT_LE(largest.share, 1.00001);
  EXPECT_GE(largest.share, 0.9);
  EXPECT_LE(largest.singular_share, 1.01);
}

TEST(MotorForce, StaysWithinLimitOnEveryDevice) {
  for (const core::DevicePreset& preset : core::kDevicePresets) {
    for (const bool signs_proven : {true, false}) {
      SCOPED_TRACE(std::string(preset.name) + (signs_proven ? " proven" : ""));
      expect_within_limit(largest_shares(preset, 0.5F * preset.drive.force_max_N, signs_proven));
    }
  }
}

TEST(MotorForce, KeepsHalfNewtonWithAnySignsInEveryPose) {
  bool meets_singular_poses = false;
  for (const core::DevicePreset& preset : core::kDevicePresets) {
    SCOPED_TRACE(preset.name);
    const Largest largest = largest_shares(preset, 0.5F, false);
    expect_within_limit(largest);
    meets_singular_poses = meets_singular_poses || largest.singular_share > 0.9;
  }
  EXPECT_TRUE(meets_singular_poses);
}

TEST(MotorForce, GivesPriorityToGravity) {
  core::GateLimits limits = roomy();
  SafetyGate gate = ramped(limits);
  const Vec3 weight = {0.0F, 0.0F, 5.0F};
  const SafetyGate::Result up = gate.command({0.0F, 0.0F, 7.0F}, kIdentity, weight);
  EXPECT_EQ(up.gravity_force, weight);
  EXPECT_NEAR(up.motor_force.z, 8.0F, 1e-3F);
  EXPECT_TRUE(is_limited(up));
  // Downwards the two forces compensate each other.
  gate = ramped(limits);
  const SafetyGate::Result down = gate.command({0.0F, 0.0F, -7.0F}, kIdentity, weight);
  EXPECT_NEAR(down.motor_force.z, -2.0F, 1e-5F);
  EXPECT_FALSE(is_limited(down));
  // A weight beyond the limit takes all of it.
  gate = ramped(limits);
  const SafetyGate::Result heavy = gate.command({1.0F, 0.0F, 0.0F}, kIdentity, {0.0F, 0.0F, 9.0F});
  EXPECT_NEAR(heavy.gravity_force.z, 8.0F, 1e-3F);
  EXPECT_NEAR(heavy.command.effort(0), 0.0F, 1e-6F);
  EXPECT_TRUE(is_limited(heavy));
}

TEST(MotorForce, KeepsDirectionOfHeavyWeight) {
  for (const Vec3 weight : {Vec3{9.0F, 9.0F, 9.0F}, Vec3{-3.0F, 9.0F, 6.0F}}) {
    SafetyGate gate = ramped();
    const SafetyGate::Result result = gate.command({}, kIdentity, weight);
    const Vec3 expected = (8.0F / core::length(weight)) * weight;
    const Vec3 efforts = {result.command.effort(0), result.command.effort(1),
                          result.command.effort(2)};
    EXPECT_NEAR(core::length(efforts - expected), 0.0F, 1e-4F);
    EXPECT_NEAR(core::length(result.gravity_force - expected), 0.0F, 1e-4F);
    EXPECT_TRUE(is_limited(result));
  }
}

// The share of the force changes by no more than the force does: it has no step at the limit.
TEST(MotorForce, ReachesLimitWithoutStep) {
  const Vec3 weight = {3.0F, 0.0F, 4.0F};
  float last = 0.0F;
  for (float force = 0.0F; force < 7.9F; force += 0.01F) {
    SafetyGate gate = ramped();
    const float now = gate.command({0.0F, force, 0.0F}, kIdentity, weight).motor_force.y;
    EXPECT_LE(std::abs(now - last), 0.02F) << force;
    last = now;
  }
  EXPECT_GT(last, 5.0F);
}

TEST(MotorForce, IsZeroInSingularPose) {
  constexpr Mat3 kFlat{{{1.0F, 0.0F, 0.0F}, {1.0F, 0.0F, 0.0F}, {0.0F, 0.0F, 1.0F}}};
  SafetyGate gate = ramped();
  for (const Vec3 weight : {Vec3{}, Vec3{1.0F, -1.0F, 0.0F}}) {
    const SafetyGate::Result result = gate.command({1.0F, 1.0F, 1.0F}, kFlat, weight);
    EXPECT_TRUE(result.command.is_zero());
    EXPECT_EQ(result.motor_force, Vec3{});
    EXPECT_EQ(result.gravity_force, Vec3{});
    EXPECT_FALSE(result.not_finite);
    EXPECT_TRUE(is_limited(result));
  }
}

TEST(MotorForce, ReportsOtherLimitsToo) {
  constexpr Mat3 kFlat{{{1.0F, 0.0F, 0.0F}, {1.0F, 0.0F, 0.0F}, {0.0F, 0.0F, 1.0F}}};
  SafetyGate gate;
  ASSERT_TRUE(gate.configure(roomy()));
  const SafetyGate::Result result = gate.command({1.0F, 1.0F, 1.0F}, kFlat);
  EXPECT_TRUE(is_limited(result));
  EXPECT_NE(result.limits & core::limit_bit(core::Limit::kRamp), 0U);
}

// The slew limit starts from efforts whose force was within the limit in the last pose.
TEST(MotorForce, FallsWithChangedPose) {
  core::GateLimits limits = roomy();
  for (float& slew : limits.effort_slew_per_tick) {
    slew = 0.1F;
  }
  limits.effort_slew_per_tick[0] = 0.1F;
  SafetyGate gate = ramped(limits);
  for (int i = 0; i < 200; ++i) {
    gate.command({7.0F, 0.0F, 0.0F}, kIdentity);
  }
  constexpr Mat3 kShort{{{0.1F, 0.0F, 0.0F}, {0.0F, 1.0F, 0.0F}, {0.0F, 0.0F, 1.0F}}};
  const SafetyGate::Result result = gate.command({7.0F, 0.0F, 0.0F}, kShort);
  EXPECT_LE(result.command.effort(0) / 0.1F, 8.0F);
  EXPECT_NEAR(result.motor_force.x, 8.0F, 1e-3F);
  EXPECT_TRUE(is_limited(result));
}

TEST(MotorForce, AddsSingleMotorsIfSignsUnproven) {
  core::GateLimits limits = roomy();
  limits.signs_proven = false;
  SafetyGate gate = ramped(limits);
  const SafetyGate::Result result = gate.command({4.0F, 4.0F, 4.0F}, kIdentity);
  EXPECT_NEAR(result.command.effort(0), 8.0F / 3.0F, 1e-4F);
  EXPECT_TRUE(is_limited(result));
  EXPECT_NEAR(core::length(result.motor_force), 8.0F / std::sqrt(3.0F), 1e-3F);
}

}  // namespace
}  // namespace tactree::test
