// Transitions from stopped to active and back: stepwise, from exactly zero force, with the dead-man
// control.

#include <gtest/gtest.h>

#include "controller_rig.hpp"

namespace tactree::test {
namespace {

using core::Command;
using core::Fault;
using core::State;

TEST(Arming, RequiresCommandAndDeadMan) {
  ControllerRig session;
  ASSERT_EQ(session.status, core::ConfigurationStatus::kOk);
  ASSERT_EQ(session.model_status, core::ModelStatus::kOk);
  EXPECT_EQ(session.state(), State::kIdle);
  session.step();
  EXPECT_EQ(session.state(), State::kIdle);
  session.step(Command::kArm);
  EXPECT_EQ(session.state(), State::kArmed);
  session.step();
  EXPECT_EQ(session.state(), State::kArmed);  // nobody holds the dead-man control
  session.input.dead_man = true;
  session.step();
  EXPECT_EQ(session.state(), State::kActive);
}

TEST(Arming, RequiresFreshDeadManPress) {
  ControllerRig session;
  session.input.dead_man = true;
  session.step(Command::kArm);
  session.rest(20);
  EXPECT_EQ(session.state(), State::kArmed);
  session.input.dead_man = false;
  session.step();
  session.input.dead_man = true;
  session.step();
  EXPECT_EQ(session.state(), State::kActive);
}

// A release during an earlier arming does not count.
TEST(Arming, ForgetsEarlierRelease) {
  ControllerRig session;
  session.step(Command::kArm);
  session.step();
  ASSERT_EQ(session.state(), State::kArmed);
  session.step(Command::kStop);
  session.input.dead_man = true;  // tied down meanwhile
  session.step(Command::kArm);
  for (int i = 0; i < 100; ++i) {
    session.step();
    ASSERT_EQ(session.state(), State::kArmed) << i;
  }
  session.input.dead_man = false;
  session.step();
  session.input.dead_man = true;
  session.step();
  EXPECT_EQ(session.state(), State::kActive);
}

TEST(Arming, EndsAddedForceOnStop) {
  ControllerRig session;
  session.activate();
  session.rest(300);
  session.input.added_force = {{1.0F, 0.0F, 0.0F}, 1'000'000U};
  ASSERT_FALSE(session.step().motors.is_zero());
  session.step(Command::kStop);
  session.input.dead_man = false;
  session.activate();
  ASSERT_EQ(session.state(), State::kActive);
  for (int i = 0; i < 300; ++i) {
    ASSERT_TRUE(session.step().motors.is_zero()) << i;
  }
}

TEST(Arming, RequiresConfirmationWithoutDeadMan) {
  core::Configuration configuration;
  configuration.supervision.dead_man_required = false;
  ControllerRig session(configuration);
  session.step(Command::kArm);
  session.rest(40);
  EXPECT_EQ(session.state(), State::kArmed);
  session.step(Command::kArm);
  EXPECT_EQ(session.state(), State::kActive);
}

TEST(Arming, WaitsForEnableLine) {
  ControllerRig session;
  session.enable_follows = false;
  session.step(Command::kArm);
  const auto waits = [](const core::Output& output) {
    return has_limit(output, core::Limit::kWaiting);
  };
  EXPECT_FALSE(waits(session.step()));  // for nothing but a hand
  session.input.dead_man = true;
  for (int i = 0; i < 10; ++i) {
    EXPECT_TRUE(waits(session.step()));
    EXPECT_EQ(session.state(), State::kArmed);
  }
  session.input.enable_read_back = true;
  session.step();
  EXPECT_EQ(session.state(), State::kActive);
  EXPECT_FALSE(waits(session.step()));
}

TEST(Arming, WaitsUntilContactEnds) {
  ControllerRig session;
  session.press(1e-3);
  session.step(Command::kArm);
  session.step();
  session.input.dead_man = true;
  for (int i = 0; i < 10; ++i) {
    EXPECT_TRUE(session.step().motors.is_zero());
    EXPECT_EQ(session.state(), State::kArmed);
  }
  session.move(0.0, 0.0, 1e-3);
  session.step();
  EXPECT_EQ(session.state(), State::kActive);
}

// The tip may be inside at power-up. While the motors are off the proxy is released, and a probe
// that leaves the object counts as outside.
TEST(Arming, ActivatesAfterLeavingFromInside) {
  for (const double from : {-0.03, -0.01, -0.002, -0.0005}) {
    ControllerRig session;
    session.move(0.0, 0.0, from);
    core::Output output = session.step();
    for (double z = from; z < 0.01; z += 1e-4) {
      session.move(0.0, 0.0, z);
      output = session.step();
    }
    EXPECT_FALSE(output.status.rendering.in_contact) << from;
    session.activate();
    EXPECT_EQ(session.state(), State::kActive) << from;
    EXPECT_GT(session.press(1e-3).status.force.z, 0.1F) << from << ": and the surface is felt";
  }
}

/// Of 15 mm radius, around the origin.
const Shape& ball() {
  static const Shape shape = sphere(0.015);
  return shape;
}

TEST(Arming, WaitsUntilProbeLeavesBody) {
  for (const double from : {0.0, 0.006, 0.012, 0.0145}) {
    ControllerRig session;
    ASSERT_EQ(session.controller.load_model(ball().view()), core::ModelStatus::kOk);
    session.move(0.0, 0.0, from);
    session.step();
    session.activate();
    EXPECT_EQ(session.state(), State::kArmed) << from;
    double z = from;
    for (; z < 0.0148; z += 1e-4) {
      session.move(0.0, 0.0, z);
      const core::Output output = session.step();
      ASSERT_EQ(session.state(), State::kArmed) << from << ", " << z;
      ASSERT_TRUE(has_limit(output, core::Limit::kWaiting)) << from << ", " << z;
      ASSERT_TRUE(output.motors.is_zero()) << from << ", " << z;
    }
    for (; z < 0.0153; z += 1e-4) {
      session.move(0.0, 0.0, z);
      session.step();
    }
    EXPECT_EQ(session.state(), State::kActive) << from;
    EXPECT_FALSE(has_limit(session.step(), core::Limit::kWaiting)) << from;
  }
}

// A sheet has two sides.
TEST(Arming, RendersBackOfSheet) {
  ControllerRig session;
  session.move(0.0, 0.0, -0.01);
  session.step();
  session.activate();
  ASSERT_EQ(session.state(), State::kActive);
  core::Output output = session.step();
  for (double z = -0.01; z < 1e-3; z += 1e-4) {
    session.move(0.0, 0.0, z);
    output = session.step();
  }
  EXPECT_LT(output.status.force.z, -0.1F);
}

TEST(Arming, RampsForceFromZero) {
  core::Configuration configuration;
  configuration.limits.ramp_s = 0.5F;
  ControllerRig session(configuration);
  session.activate();
  ASSERT_EQ(session.state(), State::kActive);
  // In 12 ticks 1 mm into the plane: 0.5 N once the ramp is over.
  float last = 0.0F;
  for (int tick = 0; tick < 600; ++tick) {
    session.move(0.0, 0.0, std::max(-1e-3, 5e-4 - tick * 1.25e-4));
    const core::Output output = session.step();
    const float force = output.motors.effort(2);
    ASSERT_GE(force, last - 1e-6F) << tick;
    ASSERT_LE(force, 0.52F * (static_cast<float>(tick) + 2.0F) / 500.0F + 1e-3F) << tick;
    last = force;
  }
  EXPECT_NEAR(last, 0.5F, 0.02F);
}

TEST(Arming, CommandsZeroUnlessActive) {
  ControllerRig session;
  core::Output output = session.press(2e-3);
  EXPECT_TRUE(output.motors.is_zero());
  EXPECT_FALSE(output.enable);
  EXPECT_TRUE(output.status.rendering.in_contact);  // known, not shown
  output = session.step(Command::kArm);
  EXPECT_TRUE(output.motors.is_zero());
  EXPECT_TRUE(output.enable);
  output = session.step(Command::kStop);
  EXPECT_TRUE(output.motors.is_zero());
  EXPECT_FALSE(output.enable);
}

TEST(Arming, EndsForceWithinSameTick) {
  ControllerRig session;
  session.activate();
  session.rest(300);
  EXPECT_GT(session.press(1e-3).motors.effort(2), 0.3F);
  session.input.dead_man = false;
  EXPECT_TRUE(session.step().motors.is_zero());
  EXPECT_EQ(session.state(), State::kArmed);
  session.step(Command::kStop);
  EXPECT_EQ(session.state(), State::kIdle);

  ControllerRig other;
  other.activate();
  other.rest(300);
  EXPECT_GT(other.press(1e-3).motors.effort(2), 0.3F);
  const core::Output output = other.step(Command::kStop);
  EXPECT_TRUE(output.motors.is_zero());
  EXPECT_FALSE(output.enable);
}

TEST(Arming, RestartsAfterClearStopArm) {
  ControllerRig session;
  session.activate();
  session.input.emergency_stop = true;
  session.step();
  EXPECT_EQ(session.state(), State::kFault);
  session.step(Command::kClearFault);  // the cause is still there
  EXPECT_TRUE(core::has_fault(session.controller.faults(), Fault::kEmergencyStop));
  session.input.emergency_stop = false;
  session.rest(10);
  EXPECT_EQ(session.state(), State::kFault);  // latched
  session.step(Command::kStop);
  EXPECT_EQ(session.state(), State::kFault);  // not cleared
  session.step(Command::kClearFault);
  EXPECT_EQ(session.state(), State::kFault);
  EXPECT_EQ(session.controller.faults(), 0U);
  session.step(Command::kStop);
  EXPECT_EQ(session.state(), State::kIdle);
  EXPECT_EQ(session.controller.faults(), 0U);
  session.input.dead_man = false;
  session.activate();
  EXPECT_EQ(session.state(), State::kActive);
}

TEST(Arming, IgnoresArmAfterClearedFault) {
  ControllerRig session;
  session.input.emergency_stop = true;
  session.step();
  session.input.emergency_stop = false;
  session.step(Command::kClearFault);
  for (int i = 0; i < 5; ++i) {
    EXPECT_FALSE(session.step(Command::kArm).enable);
    EXPECT_EQ(session.state(), State::kFault);
  }
}

TEST(Arming, RefusesChangesWhileArmed) {
  ControllerRig session;
  session.step(Command::kArm);
  EXPECT_EQ(session.controller.configure({}), core::ConfigurationStatus::kBusy);
  EXPECT_EQ(session.controller.load_model(shared_plane().view()), core::ModelStatus::kBusy);
  EXPECT_EQ(session.controller.unload_model(), core::ModelStatus::kBusy);
  EXPECT_EQ(session.state(), State::kArmed);
  session.step(Command::kStop);
  EXPECT_EQ(session.controller.unload_model(), core::ModelStatus::kOk);
  EXPECT_EQ(session.state(), State::kNoModel);
  session.step(Command::kArm);
  EXPECT_EQ(session.state(), State::kFault);
  EXPECT_TRUE(core::has_fault(session.controller.faults(), Fault::kUnexpectedEvent));
}

}  // namespace
}  // namespace tactree::test
