// Every impossible value of a configuration is refused by name.

#include "tactree/core/configuration/configuration.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "controller_rig.hpp"
#include "odd_floats.hpp"
#include "tactree/core/configuration/device_presets.hpp"

namespace tactree::test {
namespace {

using core::Configuration;
using core::ConfigurationStatus;

using Field = float& (*)(Configuration&);

const std::vector<std::pair<Field, ConfigurationStatus>>& fields() {
  using enum ConfigurationStatus;
  static const std::vector<std::pair<Field, ConfigurationStatus>> all = {
      {[](Configuration& c) -> float& { return c.rate_hz; }, kBadRate},
      {[](Configuration& c) -> float& { return c.contact.stiffness_N_m; }, kBadStiffness},
      {[](Configuration& c) -> float& { return c.contact.damping_Ns_m; }, kBadDamping},
      {[](Configuration& c) -> float& { return c.contact.static_friction; }, kBadFriction},
      {[](Configuration& c) -> float& { return c.contact.dynamic_friction; }, kBadFriction},
      {[](Configuration& c) -> float& { return c.contact.texture_height_m; }, kBadTexture},
      {[](Configuration& c) -> float& { return c.contact.texture_wavelength_m; }, kBadTexture},
      {[](Configuration& c) -> float& { return c.velocity_cutoff_hz; }, kBadFilter},
      {[](Configuration& c) -> float& { return c.device_damping_Ns_m; }, kBadDamping},
      {[](Configuration& c) -> float& { return c.hand_damping_Ns_m; }, kBadDamping},
      {[](Configuration& c) -> float& { return c.passivity_Ns_m; }, kBadDamping},
      {[](Configuration& c) -> float& { return c.delay_s; }, kBadTimeout},
      {[](Configuration& c) -> float& { return c.limits.force_max_N; }, kBadLimit},
      {[](Configuration& c) -> float& { return c.limits.slew_N_s; }, kBadLimit},
      {[](Configuration& c) -> float& { return c.limits.ramp_s; }, kBadRamp},
      {[](Configuration& c) -> float& { return c.motors.continuous_share; }, kBadLimit},
      {[](Configuration& c) -> float& { return c.motors.thermal_time_s; }, kBadLimit},
      {[](Configuration& c) -> float& { return c.supervision.speed_max_m_s; }, kBadSpeed},
      {[](Configuration& c) -> float& { return c.supervision.stuck_s; }, kBadTimeout},
      {[](Configuration& c) -> float& { return c.supervision.enable_timeout_s; }, kBadTimeout},
      {[](Configuration& c) -> float& { return c.link.timeout_s; }, kBadTimeout},
  };
  return all;
}

TEST(Configuration, AcceptsDefaults) {
  EXPECT_EQ(core::check(Configuration{}), ConfigurationStatus::kOk);
}

TEST(Configuration, RefusesNaNInfinityAndNegatives) {
  for (const auto& [field, status] : fields()) {
    for (const float bad :
         {-1.0F, std::numeric_limits<float>::max(), std::numeric_limits<float>::infinity(),
          -std::numeric_limits<float>::infinity(), std::numeric_limits<float>::quiet_NaN()}) {
      Configuration c;
      field(c) = bad;
      EXPECT_EQ(core::check(c), status) << bad << ", " << core::describe(status);
      core::Controller controller;
      EXPECT_EQ(controller.configure(c), status);
      EXPECT_EQ(controller.state(), core::State::kBoot);
    }
  }
}

TEST(Configuration, LimitsForceForUnusualFloats) {
  for (const auto& [field, status] : fields()) {
    for (const float odd : kOddFloats) {
      Configuration c;
      c.limits.ramp_s = 0.01F;
      field(c) = odd;
      ControllerRig session(c);
      session.activate();
      session.rest(30);
      const core::Output output = session.press(2e-3);
      ASSERT_TRUE(std::isfinite(output.motors.effort(2)));
      if (session.status == ConfigurationStatus::kOk) {
        ASSERT_LE(std::abs(output.motors.effort(2)),
                  session.controller.configuration().limits.force_max_N);
      } else {
        ASSERT_TRUE(output.motors.is_zero());
      }
    }
  }
}

TEST(Configuration, ChecksEveryVectorComponent) {
  for (std::uint32_t axis = 0; axis < core::kAxes; ++axis) {
    for (const float bad : {0.0F, -1.0F, std::numeric_limits<float>::infinity(),
                            std::numeric_limits<float>::quiet_NaN()}) {
      Configuration c;
      c.device.counts_per_m[axis] = bad;
      EXPECT_EQ(core::check(c), ConfigurationStatus::kBadDevice);
      c = {};
      c.motors.effort_max[axis] = bad;
      EXPECT_EQ(core::check(c), ConfigurationStatus::kBadLimit);
      c = {};
      c.motors.effort_slew_s[axis] = bad;
      EXPECT_EQ(core::check(c), ConfigurationStatus::kBadLimit);
    }
  }
  Configuration c;
  c.model_origin_m.y = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(core::check(c), ConfigurationStatus::kBadOrigin);
  c = {};
  c.mode = static_cast<core::RenderMode>(9);
  EXPECT_EQ(core::check(c), ConfigurationStatus::kBadMode);
  c = {};
  c.device.kind = static_cast<core::DeviceKind>(9);
  EXPECT_EQ(core::check(c), ConfigurationStatus::kBadDevice);
}

TEST(Configuration, RefusesDynamicAboveStaticFriction) {
  Configuration c;
  c.contact.static_friction = 0.2F;
  c.contact.dynamic_friction = 0.21F;
  EXPECT_EQ(core::check(c), ConfigurationStatus::kBadFriction);
  c.contact.dynamic_friction = 0.2F;
  EXPECT_EQ(core::check(c), ConfigurationStatus::kOk);
}

TEST(Configuration, RefusesTextureSteeperThanHalfItsWavelength) {
  Configuration c;
  c.contact.texture_wavelength_m = 1e-3F;
  c.contact.texture_height_m = 0.5e-3F;
  EXPECT_EQ(core::check(c), ConfigurationStatus::kOk);
  c.contact.texture_height_m = 0.51e-3F;
  EXPECT_EQ(core::check(c), ConfigurationStatus::kBadTexture);
  EXPECT_STREQ(core::refusal_of(c).field, "contact.texture_height_m");
  c.contact.texture_wavelength_m = 1.0F;
  c.contact.texture_height_m = 0.0101F;
  EXPECT_EQ(core::check(c), ConfigurationStatus::kBadTexture);
}

// Colgate and Brown: K < (b + b_hand) / (T / 2 + t_d).
TEST(Configuration, RefusesStiffnessAboveStabilityLimit) {
  Configuration c;
  c.device_damping_Ns_m = 0.1F;
  c.hand_damping_Ns_m = 1.0F;
  c.contact.damping_Ns_m = 0.0F;
  c.passivity_Ns_m = 0.0F;
  EXPECT_NEAR(core::stability_limit(c).with_hand_N_m, 2200.0F, 1.0F);
  EXPECT_NEAR(core::stability_limit(c).without_hand_N_m, 200.0F, 0.1F);
  c.delay_s = 0.3e-3F;
  EXPECT_NEAR(core::stability_limit(c).with_hand_N_m, 1375.0F, 1.0F);
  c.contact.stiffness_N_m = 1370.0F;
  EXPECT_EQ(core::check(c), ConfigurationStatus::kOk);
  c.contact.stiffness_N_m = 1380.0F;
  EXPECT_EQ(core::check(c), ConfigurationStatus::kUnstable);
  c.rate_hz = 4000.0F;
  c.delay_s = 0.0F;
  EXPECT_NEAR(core::stability_limit(c).with_hand_N_m, 8800.0F, 4.0F);
}

TEST(Configuration, NamesRefusedFieldAndRange) {
  Configuration c;
  c.limits.force_max_N = 0.5F;  // the default slew of 2 N per tick is then too fast
  core::Refusal refusal = core::refusal_of(c);
  EXPECT_EQ(refusal.status, ConfigurationStatus::kBadLimit);
  EXPECT_STREQ(refusal.field, "limits.slew_N_s");
  EXPECT_EQ(refusal.value, 2000.0F);
  EXPECT_NEAR(refusal.min, 0.05F, 1e-6F);
  EXPECT_NEAR(refusal.max, 1000.0F, 1e-3F);
  core::limit_force(c, 0.5F);
  EXPECT_EQ(core::refusal_of(c).status, ConfigurationStatus::kOk);
  for (const auto& [field, status] : fields()) {
    Configuration bad;
    field(bad) = -1.0F;
    refusal = core::refusal_of(bad);
    EXPECT_NE(std::string(refusal.field), "") << core::describe(status);
    EXPECT_EQ(refusal.value, -1.0F) << refusal.field;
    EXPECT_LT(refusal.value, refusal.min) << refusal.field;
    field(bad) = refusal.min;
    EXPECT_NE(core::refusal_of(bad).field, std::string(refusal.field));
  }
}

TEST(Configuration, NamesRefusedFieldOfDevice) {
  const auto refusal_with = [](core::DeviceKind kind, const auto& change) {
    Configuration c;
    for (const core::DevicePreset& preset : core::kDevicePresets) {
      if (preset.model.kind == kind) {
        core::use_device(preset, c);
      }
    }
    EXPECT_EQ(core::refusal_of(c).status, ConfigurationStatus::kOk);
    change(c.device);
    const core::Refusal refusal = core::refusal_of(c);
    EXPECT_EQ(refusal.status, ConfigurationStatus::kBadDevice);
    return refusal;
  };
  using enum core::DeviceKind;
  core::Refusal refusal = refusal_with(kArm, [](auto& d) { d.arm.forearm_m = 0.0F; });
  EXPECT_STREQ(refusal.field, "device.arm.forearm_m");
  EXPECT_EQ(refusal.axis, -1);
  EXPECT_EQ(refusal.value, 0.0F);
  EXPECT_EQ(refusal.min, 0.01F);
  EXPECT_EQ(refusal.max, 10.0F);
  refusal = refusal_with(kDelta, [](auto& d) { d.ratio[1] = -1e-4F; });
  EXPECT_STREQ(refusal.field, "device.ratio");
  EXPECT_EQ(refusal.axis, 1);
  EXPECT_EQ(refusal.value, 1e-4F);
  refusal = refusal_with(kDelta, [](auto& d) { d.delta.leg_rad[2] = 7.0F; });
  EXPECT_STREQ(refusal.field, "device.delta.leg_rad");
  EXPECT_EQ(refusal.axis, 2);
  refusal = refusal_with(kFiveBar, [](auto& d) { d.home_position[1] = d.joint_max[1] + 0.1F; });
  EXPECT_STREQ(refusal.field, "device.home_position");
  EXPECT_EQ(refusal.axis, 1);
  refusal = refusal_with(kPaddle, [](auto& d) { d.joint_max[0] = d.joint_min[0]; });
  EXPECT_STREQ(refusal.field, "device.joint_max");
  EXPECT_EQ(refusal.axis, 0);
  EXPECT_EQ(refusal.value, refusal.min);
  refusal =
      refusal_with(kCartesian, [](auto& d) { d.homing = static_cast<core::HomingMethod>(7); });
  EXPECT_STREQ(refusal.field, "device.homing");
}

TEST(Configuration, RefusesDelayBeyondObservation) {
  Configuration c;
  c.contact.stiffness_N_m = 10.0F;
  c.delay_s = 0.015F;
  EXPECT_EQ(core::check(c), ConfigurationStatus::kOk);
  c.delay_s = 0.0151F;
  EXPECT_EQ(core::check(c), ConfigurationStatus::kBadTimeout);
  c.rate_hz = 100.0F;
  c.velocity_cutoff_hz = 50.0F;
  c.delay_s = 0.1F;
  EXPECT_NE(core::check(c), ConfigurationStatus::kBadTimeout);
}

TEST(FirstForce, IsValidForEveryDeviceAndRate) {
  for (const core::DevicePreset& preset : core::kDevicePresets) {
    for (const float rate_hz : {500.0F, 1000.0F, 4000.0F, 10000.0F}) {
      Configuration c;
      core::use_device(preset, c);
      c.rate_hz = rate_hz;
      core::limit_to_rate(c);
      core::limit_force(c, c.limits.force_max_N);
      ASSERT_EQ(core::check(c), ConfigurationStatus::kOk) << preset.name << " " << rate_hz;
      const Configuration first = core::first_force(c);
      EXPECT_EQ(core::check(first), ConfigurationStatus::kOk) << preset.name << " " << rate_hz;
      EXPECT_EQ(first.limits.force_max_N, core::kFirstForce_N);
      EXPECT_FALSE(first.compensate_gravity);
      EXPECT_FALSE(first.motors.signs_proven);
      const float share = core::kFirstForce_N / c.limits.force_max_N;
      EXPECT_FLOAT_EQ(first.limits.slew_N_s, share * c.limits.slew_N_s);
      EXPECT_FLOAT_EQ(first.motors.effort_max[0], share * c.motors.effort_max[0]);
      EXPECT_FLOAT_EQ(first.motors.effort_slew_s[0], share * c.motors.effort_slew_s[0]);
    }
  }
}

// The slew rate of a tick is a product, which may be rounded up.
TEST(LimitForce, IsValidForEveryForceAndRate) {
  for (const float rate_hz : {100.0F, 500.0F, 1000.0F, 3000.0F, 4000.0F, 7001.0F, 20000.0F}) {
    for (int hundredths = 1; hundredths <= 500; ++hundredths) {
      Configuration c;
      c.rate_hz = rate_hz;
      core::limit_to_rate(c);
      c.contact.stiffness_N_m = 100.0F;
      c.limits.slew_N_s = 1e9F;
      for (std::uint32_t axis = 0; axis < core::kAxes; ++axis) {
        c.motors.effort_slew_s[axis] = c.motors.effort_max[axis] * rate_hz;
      }
      core::limit_force(c, static_cast<float>(0.01 * hundredths));
      const core::Refusal refusal = core::refusal_of(c);
      ASSERT_EQ(refusal.status, ConfigurationStatus::kOk)
          << refusal.field << " at " << 0.01 * hundredths << " N and " << rate_hz << " Hz";
    }
  }
}

TEST(FirstForce, KeepsSmallerForce) {
  Configuration c;
  core::limit_force(c, 0.2F);
  EXPECT_EQ(core::first_force(c).limits.force_max_N, 0.2F);
}

// The smallest effort that the gate accepts is kept.
TEST(FirstForce, KeepsMinimumEffort) {
  Configuration c;
  for (std::uint32_t axis = 0; axis < core::kAxes; ++axis) {
    c.motors.effort_max[axis] = 2e-4F;
    c.motors.effort_slew_s[axis] = 0.05F;
  }
  ASSERT_EQ(core::check(c), ConfigurationStatus::kOk);
  const Configuration first = core::first_force(c);
  EXPECT_EQ(core::check(first), ConfigurationStatus::kOk);
  EXPECT_EQ(first.motors.effort_max[2], 1e-4F);
}

// A motor with the wrong sign would add the weight that it should carry.
TEST(Configuration, RefusesGravityCompensationWithoutProvenSigns) {
  for (const bool compensate : {false, true}) {
    for (const bool proven : {false, true}) {
      Configuration c;
      c.compensate_gravity = compensate;
      c.motors.signs_proven = proven;
      EXPECT_EQ(core::check(c), compensate && !proven ? ConfigurationStatus::kUnprovenSigns
                                                      : ConfigurationStatus::kOk);
    }
  }
}

TEST(Configuration, DescribesEveryStatusUniquely) {
  constexpr int kLast = static_cast<int>(ConfigurationStatus::kUnprovenSigns);
  for (int i = 0; i <= kLast; ++i) {
    EXPECT_NE(std::string(core::describe(static_cast<ConfigurationStatus>(i))), "unknown status");
    for (int k = i + 1; k <= kLast; ++k) {
      EXPECT_NE(std::string(core::describe(static_cast<ConfigurationStatus>(i))),
                core::describe(static_cast<ConfigurationStatus>(k)));
    }
  }
  EXPECT_EQ(std::string(core::describe(static_cast<ConfigurationStatus>(99))), "unknown status");
}

TEST(LoadModel, ReturnsReasonOfRefusal) {
  core::Controller controller;
  EXPECT_EQ(controller.load_model(shared_plane().view()), core::ModelStatus::kNotConfigured);
  ASSERT_EQ(controller.configure({}), ConfigurationStatus::kOk);
  EXPECT_EQ(controller.load_model(core::BlobView{}), core::ModelStatus::kEmpty);
  EXPECT_EQ(controller.state(), core::State::kNoModel);
  EXPECT_EQ(controller.load_model(shared_plane().view()), core::ModelStatus::kOk);
  EXPECT_EQ(controller.state(), core::State::kIdle);
}

}  // namespace
}  // namespace tactree::test
