// Homing after power-up by each method; no force before it is done.

#include "tactree/core/device/homing.hpp"

#include <gtest/gtest.h>

#include "controller_rig.hpp"
#include "tactree/core/configuration/device_presets.hpp"

namespace tactree::test {
namespace {

using core::Command;
using core::DeviceModel;
using core::EncoderReading;
using core::Homing;
using core::HomingMethod;
using core::State;

DeviceModel device_with(HomingMethod method) {
  DeviceModel device = core::presets::premium().model;
  device.homing = method;
  return device;
}

EncoderReading at(std::int32_t a, std::int32_t b, std::int32_t c) {
  EncoderReading reading{{a, b, c}, {true, true, true}};
  return reading;
}

TEST(Homing, IsNotDoneBeforeBegin) { EXPECT_FALSE(Homing{}.done()); }

TEST(Homing, SkipsAbsoluteEncoders) {
  Homing homing;
  homing.begin(device_with(HomingMethod::kAbsolute));
  EXPECT_TRUE(homing.done());
}

TEST(Homing, RequiresCommandForGivenPose) {
  DeviceModel device = device_with(HomingMethod::kGivenPose);
  Homing homing;
  homing.begin(device);
  EXPECT_TRUE(homing.update(at(5, -6, 7), false, device));
  EXPECT_FALSE(homing.done());
  EXPECT_TRUE(homing.update(at(15, -16, 17), true, device));
  EXPECT_TRUE(homing.done());
  const core::DevicePose pose = core::locate(device, {15, -16, 17});
  EXPECT_EQ(pose.joints, (core::Vec3{0.0F, 0.0F, 0.0F}));
}

TEST(Homing, RequiresEveryIndexPulse) {
  DeviceModel device = device_with(HomingMethod::kIndex);
  Homing homing;
  homing.begin(device);
  for (std::uint32_t axis = 0; axis < core::kAxes; ++axis) {
    EXPECT_FALSE(homing.done());
    EncoderReading reading = at(100, 200, 300);
    reading.index[axis] = true;
    reading.index_count[axis] = 42 + static_cast<std::int32_t>(axis);
    EXPECT_TRUE(homing.update(reading, true, device));
  }
  EXPECT_TRUE(homing.done());
  EXPECT_EQ(device.home_count[2], 44);
  EncoderReading again = at(0, 0, 0);
  again.index[1] = true;
  again.index_count[1] = 43 + Homing::kIndexSlack;
  EXPECT_TRUE(homing.update(again, false, device));
  again.index_count[1] = 43 + Homing::kIndexSlack + 1;
  EXPECT_FALSE(homing.update(again, false, device));  // counts were lost
}

TEST(Homing, FindsCentreBetweenStops) {
  for (const float direction : {1.0F, -1.0F}) {
    DeviceModel device = device_with(HomingMethod::kHardStop);
    for (float& ratio : device.ratio) {
      ratio *= direction;
    }
    Homing homing;
    homing.begin(device);
    const std::int32_t power_up = 0x7FFFFFF0;  // the counter wraps on the way
    const auto count_of = [&](std::uint32_t axis, float joint) {
      const float counts = core::counts_per_unit(device, axis) * joint;
      return static_cast<std::int32_t>(
          static_cast<std::uint32_t>(power_up) +
          static_cast<std::uint32_t>(static_cast<std::int32_t>(counts)));
    };
    const auto move_to = [&](float share) {
      std::int32_t counts[core::kAxes];
      for (std::uint32_t axis = 0; axis < core::kAxes; ++axis) {
        counts[axis] = count_of(axis, device.joint_min[axis] + share * (device.joint_max[axis] -
                                                                        device.joint_min[axis]));
      }
      EXPECT_TRUE(homing.update(at(counts[0], counts[1], counts[2]), false, device));
      return core::joints_of(device, counts);
    };
    for (const float share : {0.5F, 0.1F, 0.001F, 0.4F, 0.9F}) {
      move_to(share);
      EXPECT_FALSE(homing.done());
    }
    move_to(0.999F);
    EXPECT_TRUE(homing.done());
    const core::Vec3 joints = move_to(0.5F);
    EXPECT_NEAR(joints.x, 0.5F * (device.joint_min[0] + device.joint_max[0]), 2e-3F);
    EXPECT_NEAR(joints.z, 0.5F * (device.joint_min[2] + device.joint_max[2]), 2e-3F);
  }
}

TEST(Homing, RestartsOnTravelBeyondRange) {
  DeviceModel device = device_with(HomingMethod::kHardStop);
  Homing homing;
  homing.begin(device);
  EXPECT_TRUE(homing.update(at(0, 0, 0), false, device));
  EXPECT_TRUE(homing.update(at(900000, 900000, 900000), false, device));
  EXPECT_FALSE(homing.done());
}

core::Configuration premium_to_be_homed() {
  core::Configuration configuration;
  core::use_device(core::presets::premium(), configuration);
  configuration.model_origin_m = {0.0F, 0.0F, -0.03F};
  configuration.limits.ramp_s = 0.002F;
  return configuration;
}

TEST(Homing, IsRequiredByDefault) { EXPECT_NE(DeviceModel{}.homing, HomingMethod::kAbsolute); }

TEST(Homing, AllowsNoForceUntilDone) {
  ControllerRig session(premium_to_be_homed(), HomingMethod::kGivenPose);
  ASSERT_EQ(session.status, core::ConfigurationStatus::kOk);
  for (std::int32_t& count : session.input.encoders.counts) {
    count = 123456;  // anywhere
  }
  core::Output output = session.step();
  EXPECT_EQ(output.status.limits, core::limit_bit(core::Limit::kNotHomed));
  session.activate();
  for (int i = 0; i < 20; ++i) {
    output = session.step();
    ASSERT_TRUE(output.motors.is_zero());
    ASSERT_FALSE(output.enable);
  }
  EXPECT_EQ(session.state(), State::kIdle);
  EXPECT_EQ(session.controller.faults(), 0U);

  session.input.dead_man = false;
  session.step(Command::kHome);
  EXPECT_TRUE(session.controller.homed());
  session.activate();
  EXPECT_EQ(session.state(), State::kActive);
  output = session.rest(20);
  EXPECT_FALSE(output.motors.is_zero());  // holds the arm's weight
  EXPECT_EQ(output.status.force, core::Vec3{});
}

TEST(Homing, RefusesCommandWhilePowered) {
  ControllerRig session(premium_to_be_homed(), HomingMethod::kGivenPose);
  session.step(Command::kHome);
  session.activate();
  ASSERT_EQ(session.state(), State::kActive);
  session.step(Command::kHome);
  EXPECT_TRUE(core::has_fault(session.controller.faults(), core::Fault::kUnexpectedEvent));
  EXPECT_TRUE(session.controller.homed());
}

TEST(Homing, ForgetsHomeOnLostCounter) {
  ControllerRig session(premium_to_be_homed(), HomingMethod::kGivenPose);
  session.step(Command::kHome);
  ASSERT_TRUE(session.controller.homed());
  session.input.encoders.valid[1] = false;
  session.step();
  EXPECT_FALSE(session.controller.homed());
  session.input.encoders.valid[1] = true;
  session.step(Command::kClearFault);
  session.step(Command::kStop);
  EXPECT_FALSE(session.controller.homed());
}

TEST(Homing, ForgetsHomeOnCounterJump) {
  ControllerRig session(premium_to_be_homed(), HomingMethod::kGivenPose);
  session.step(Command::kHome);
  session.input.encoders.counts[1] += 2000;  // 0.27 rad in one tick
  const core::Output output = session.step();
  EXPECT_TRUE(core::has_fault(output.status.faults, core::Fault::kEncoderJump));
  EXPECT_FALSE(session.controller.homed());
}

}  // namespace
}  // namespace tactree::test
