// State between ticks: kept and discarded parts.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "controller_rig.hpp"
#include "tactree/core/configuration/device_presets.hpp"
#include "tactree/core/control/passivity.hpp"

namespace tactree::test {
namespace {

using core::Command;
using core::Fault;
using core::Limit;
using core::State;
using core::Vec3;

constexpr double kAbove = 0.01;   // m: free space on either side of the plane
constexpr double kBelow = -0.01;  // m

core::Output settle(ControllerRig& session, int ticks = 200) { return session.rest(ticks + 1); }

TEST(Tick, ReportsVelocityOfHand) {
  ControllerRig session;
  core::Output output = session.step();
  for (int i = 0; i < 400; ++i) {
    session.move(0.0, 0.0, 0.1 - 1e-4 * i);
    output = session.step();
  }
  EXPECT_NEAR(static_cast<double>(output.status.velocity.z), -0.1, 0.005);
}

// A proxy that kept its position would hit the plane on the path to the new one.
TEST(Tick, TouchesNothingAcrossLongGap) {
  ControllerRig session;
  session.move(0.0, 0.0, kAbove);
  settle(session);
  core::Output moving = session.step();
  for (int i = 0; i < 50; ++i) {
    session.move(1e-4 * i, 0.0, kAbove);
    moving = session.step();
  }
  ASSERT_GT(moving.status.velocity.x, 0.05F);
  session.input.encoders.valid[2] = false;
  EXPECT_EQ(session.step().status.velocity, Vec3{});
  session.move(0.0, 0.0, kBelow);
  session.input.encoders.valid[2] = true;
  for (int i = 0; i < 5; ++i) {
    const core::Output output = session.step();
    EXPECT_FALSE(output.status.rendering.in_contact);
    EXPECT_EQ(output.status.velocity, Vec3{});
  }
}

TEST(Tick, ReportsNoVelocityAfterJump) {
  ControllerRig session;
  session.move(0.0, 0.0, kAbove);
  settle(session);
  session.move(0.0, 0.0, kBelow);
  EXPECT_TRUE(core::has_fault(session.step().status.faults, Fault::kEncoderJump));
  for (int i = 0; i < 5; ++i) {
    const core::Output output = session.step();
    EXPECT_FALSE(output.status.rendering.in_contact);
    EXPECT_EQ(output.status.velocity, Vec3{});
  }
}

// Counts that are impossible for the arms of a delta.
TEST(Tick, ReportsImpossiblePoseWithoutVelocity) {
  core::Configuration configuration;
  core::use_device(core::presets::falcon(), configuration);
  configuration.device.homing = core::HomingMethod::kAbsolute;
  ControllerRig session(configuration);
  ASSERT_EQ(session.status, core::ConfigurationStatus::kOk);
  for (std::uint32_t axis = 0; axis < core::kAxes; ++axis) {
    session.input.encoders.counts[axis] = configuration.device.home_count[axis];
  }
  core::Output output = session.step();
  for (int i = 0; i < 50; ++i) {
    session.input.encoders.counts[0] += 1;
    output = session.step();
  }
  ASSERT_NE(output.status.velocity, Vec3{});
  session.input.encoders.counts[0] += 4000;  // 146 degrees
  output = session.step();
  EXPECT_TRUE(core::has_fault(output.status.faults, Fault::kEncoderInvalid));
  EXPECT_EQ(output.status.velocity, Vec3{});
}

TEST(Tick, AcceptsNewConfigurationWithoutJump) {
  core::Configuration configuration;
  ControllerRig session(configuration);
  settle(session);
  configuration.model_origin_m = {0.0F, 0.0F, 1.0F};
  ASSERT_EQ(session.controller.configure(configuration), core::ConfigurationStatus::kOk);
  EXPECT_EQ(session.step().status.faults, 0U);
}

TEST(Tick, RecoversWithoutModel) {
  core::Controller controller;
  ASSERT_EQ(controller.configure({}), core::ConfigurationStatus::kOk);
  ControllerRig rig;
  core::Input input = rig.input;
  input.motors_ok = false;
  (void)controller.step(input);
  ASSERT_EQ(controller.state(), State::kFault);
  input.motors_ok = true;
  input.command = Command::kClearFault;
  (void)controller.step(input);
  input.command = Command::kStop;
  (void)controller.step(input);
  EXPECT_EQ(controller.state(), State::kNoModel);
}

TEST(Tick, ReportsWaitingForEnableLine) {
  ControllerRig session;
  session.step(Command::kArm);
  EXPECT_FALSE(has_limit(session.step(), Limit::kWaiting));  // nobody is there yet
  session.enable_follows = false;
  session.input.enable_read_back = false;
  session.input.dead_man = true;
  EXPECT_TRUE(has_limit(session.step(), Limit::kWaiting));
  EXPECT_FALSE(has_limit(session.step(Command::kStop), Limit::kWaiting));
}

TEST(Tick, CountsArmCommandOnce) {
  core::Configuration configuration;
  configuration.supervision.dead_man_required = false;
  ControllerRig session(configuration);
  session.enable_follows = false;
  session.input.enable_read_back = true;
  const core::Output output = session.step(Command::kArm);
  EXPECT_EQ(session.state(), State::kArmed);
  EXPECT_FALSE(has_limit(output, Limit::kWaiting));
}

// Arming again while armed changes nothing: an earlier release still counts.
TEST(Tick, IgnoresSecondArmCommand) {
  ControllerRig session;
  session.step(Command::kArm);
  session.step();
  session.input.dead_man = true;
  session.step(Command::kArm);
  EXPECT_EQ(session.state(), State::kActive);
}

// The second copy of the state, checked before a command goes to the motors.
TEST(Tick, AllowsForceOnlyWhenActive) {
  ControllerRig session;
  EXPECT_FALSE(session.controller.may_give_force());
  session.step(Command::kArm);
  EXPECT_FALSE(session.controller.may_give_force());
  session.step();
  session.input.dead_man = true;
  session.step();
  EXPECT_TRUE(session.controller.may_give_force());
  session.step(Command::kStop);
  EXPECT_FALSE(session.controller.may_give_force());
}

TEST(Tick, ReportsNoReactionAfterStop) {
  ControllerRig session;
  session.activate();
  settle(session, 400);
  ASSERT_GT(session.press(2e-3).status.force.z, 0.5F);
  session.input.added_force = {{0.0F, 0.0F, -1.0F}, 1000};
  ASSERT_NE(session.step().status.reactions[0].force_N, Vec3{});
  const core::Output stopped = session.step(Command::kStop);
  EXPECT_EQ(stopped.status.reactions[0].body, core::kNoBody);
}

// Shorter than the jump that a body notices by itself.
TEST(Tick, TouchesNothingAcrossShortGap) {
  ControllerRig session;
  session.move(0.0, 0.0, 1e-3);
  settle(session);
  session.input.encoders.valid[2] = false;
  session.step();
  session.move(0.0, 0.0, -1e-3);
  session.input.encoders.valid[2] = true;
  for (int i = 0; i < 5; ++i) {
    EXPECT_FALSE(session.step().status.rendering.in_contact) << i;
  }
}

TEST(Tick, ForgetsContactOnConfiguration) {
  ControllerRig session;
  session.activate();
  settle(session);
  ASSERT_TRUE(session.press(1e-3).status.rendering.in_contact);
  session.step(Command::kStop);
  settle(session);
  ASSERT_TRUE(session.step().status.rendering.in_contact);
  ASSERT_EQ(session.controller.configure(session.controller.configuration()),
            core::ConfigurationStatus::kOk);
  EXPECT_FALSE(settle(session).status.rendering.in_contact);
}

TEST(Tick, IgnoresEncodersBeforeConfiguration) {
  core::Controller controller;
  core::Input input;
  input.emergency_stop = false;
  input.motors_ok = true;
  input.link_alive = true;
  EXPECT_FALSE(core::has_fault(controller.step(input).status.faults, Fault::kEncoderInvalid));
}

TEST(Tick, PushesProbeWithMovingBody) {
  ControllerRig session;
  session.activate();
  settle(session, 400);
  core::Output output = session.step();
  for (int i = 1; i <= 120; ++i) {
    core::BodyUpdate update;
    update.body = 0;
    update.pose.translation_m.z = static_cast<float>(1e-4 * i);
    session.updates = {update};
    output = session.step();
  }
  EXPECT_TRUE(output.status.rendering.in_contact);
  EXPECT_GT(output.status.force.z, 0.5F);
}

TEST(Tick, ExpiresAddedForce) {
  ControllerRig session;
  session.activate();
  settle(session, 400);
  session.input.added_force = {{0.5F, 0.0F, 0.0F}, 40};
  EXPECT_GT(settle(session, 38).status.force.x, 0.4F);
  EXPECT_EQ(settle(session, 100).status.force, Vec3{});
}

TEST(Tick, ExcludesAddedForceFromReaction) {
  ControllerRig session;
  session.activate();
  settle(session, 400);
  session.press(1e-3);
  session.input.added_force = {{0.0F, 0.0F, 0.5F}, 20};
  const core::Output during = settle(session, 15);
  const core::Output after = settle(session, 200);
  ASSERT_GT(after.status.force.z, 0.5F);
  EXPECT_GT(during.status.force.z, after.status.force.z + 0.2F);
  EXPECT_EQ(after.status.reactions[0].force_N, -after.status.force);
}

TEST(Tick, DiscardsUnusedAddedForce) {
  ControllerRig session;
  session.input.added_force = {{1.0F, 0.0F, 0.0F}, 1'000'000U};
  session.step();
  session.activate();
  for (int i = 0; i < 400; ++i) {
    ASSERT_TRUE(session.step().motors.is_zero()) << i;
  }
}

// The controller adds the damping of the passivity controller: compared with a separate instance.
TEST(Tick, KeepsWallPassive) {
  core::Configuration configuration;
  configuration.limits.ramp_s = 0.01F;
  configuration.delay_s = 0.003F;
  configuration.contact.stiffness_N_m = 150.0F;
  configuration.passivity_Ns_m = 2.0F;
  ControllerRig session(configuration);
  ASSERT_EQ(session.status, core::ConfigurationStatus::kOk);
  session.activate();
  settle(session, 50);
  core::PassivityController observer;
  observer.configure(1.0F / configuration.rate_hz, configuration.passivity_Ns_m,
                     configuration.delay_s);
  Vec3 shown{};
  int added_ticks = 0;
  for (int i = 0; i < 2000; ++i) {
    session.move(0.0, 0.0, 1e-3 * std::cos(0.05 * i));
    const core::Output output = session.step();
    const core::Rendering& r = output.status.rendering;
    if (!r.in_contact) {
      observer.reset();
    } else {
      const Vec3 added = observer.update(shown, {output.status.probe, output.status.velocity, {}},
                                         r.stored_energy);
      const Vec3 force = r.force + added;
      const float push = core::dot(force, r.normal);
      const float leaving = core::dot(output.status.velocity, r.normal);
      const float most =
          leaving > 0.0F ? observer.most_push(leaving, configuration.limits.slew_N_s) : push;
      const float allowed = std::clamp(push, 0.0F, std::max(most, 0.0F));
      const Vec3 expected = force + (allowed - push) * r.normal;
      ASSERT_EQ(output.status.limits, 0U) << i;
      ASSERT_NEAR(output.status.force.z, expected.z, 1e-5F) << i;
      added_ticks += added == Vec3{} ? 0 : 1;
    }
    shown = output.status.force;
  }
  EXPECT_GT(added_ticks, 100);
}

/// Force of each tick of a hand that is inside the plane from one tick to the next and draws back
/// from there, after `change` was done in free space.
template <class Change>
std::vector<float> draw_back(Change change) {
  core::Configuration configuration;
  configuration.limits.ramp_s = 0.01F;
  ControllerRig session(configuration);
  session.activate();
  session.move(0.0, 0.0, 1e-3);
  settle(session, 50);
  change(session);
  std::vector<float> forces;
  settle(session, 1);
  for (int tick = 0; tick < 100; ++tick) {
    session.move(0.0, 0.0, 2e-5 * tick - 1e-3);
    forces.push_back(session.step().status.force.z);
  }
  return forces;
}

// A change of the wall allows a release of spring energy only during contact.
TEST(Tick, IgnoresUntouchedWallChange) {
  const std::vector<float> plain = draw_back([](ControllerRig& /*as it is*/) {});
  EXPECT_GT(*std::max_element(plain.begin(), plain.end()), 0.1F);
  EXPECT_EQ(plain, draw_back([](ControllerRig& session) {
              session.updates = {{0, true, {}, {}}};
            }));
  EXPECT_EQ(plain, draw_back([](ControllerRig& session) {
              core::Controller& controller = session.controller;
              ASSERT_EQ(controller.adjust(controller.adjustment()), core::ConfigurationStatus::kOk);
            }));
}

}  // namespace
}  // namespace tactree::test
