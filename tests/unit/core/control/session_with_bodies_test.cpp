// Several bodies under a whole controller: gate, limits, reactions, states.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>

#include "controller_rig.hpp"
#include "poses.hpp"

namespace tactree::test {
namespace {

using core::Limit;
using core::ModelStatus;
using core::State;

/// Of a session with the plane as body 0 and as many more as wanted, active.
class SessionWithBodies : public ControllerRig {
 public:
  explicit SessionWithBodies(std::initializer_list<Eigen::Isometry3d> more,
                             const core::Configuration& configuration = {})
      : ControllerRig(configuration) {
    for (const Eigen::Isometry3d& pose : more) {
      std::uint32_t number = 0;
      EXPECT_EQ(controller.add_body(shared_plane().view(), core::normalized(to_core(pose)), number),
                ModelStatus::kOk);
    }
    activate();
    for (int i = 0; i < 300; ++i) {
      step();  // the ramp
    }
    EXPECT_EQ(state(), State::kActive);
  }
};

TEST(SessionWithBodies, FadesForceOfRemovedBody) {
  for (const bool remove : {true, false}) {
    SessionWithBodies session({kFar});
    float before = session.press(2e-3).status.force.z;
    EXPECT_GT(before, 0.8F);
    const float step_max = before / (core::kFadeSeconds * 1000.0F) + 1e-4F;
    if (remove) {
      ASSERT_EQ(session.controller.remove_body(0), ModelStatus::kOk);
    } else {
      session.updates = {{0, false, {}, {}}};
    }
    int ticks = 0;
    for (; before > 0.0F && ticks < 100; ++ticks) {
      const core::Output output = session.step();
      ASSERT_EQ(session.state(), State::kActive);
      ASSERT_LE(std::abs(output.status.force.z - before), step_max);
      ASSERT_TRUE(has_limit(output, Limit::kBoundary));
      before = output.status.force.z;
    }
    EXPECT_EQ(ticks, 50);
    EXPECT_FALSE(has_limit(session.step(), Limit::kBoundary));
  }
}

// Also of a force that changes faster than it should: the gate's slew holds whatever bodies do.
TEST(SessionWithBodies, LimitsSlewOfBodyChanges) {
  core::Configuration slow;
  slow.limits.slew_N_s = 100.0F;
  SessionWithBodies session({kFar}, slow);
  core::Vec3 before = session.press(2e-3).status.force;
  float furthest = 0.0F;
  for (int i = 0; i < 2000; ++i) {
    const auto z = static_cast<float>((i % 40) * 2e-4 - 4e-3);
    session.updates = {{0, i % 170 < 150, {{}, {0.0F, 0.0F, z}}, {}}};
    session.move(0.0, 0.0,
                 -2e-3 - 1e-4 * (i % 2));  // no hand stands still while it is pushed about
    const core::Vec3 force = session.step().status.force;
    furthest = std::max(furthest, core::length(force - before));
    before = force;
  }
  EXPECT_EQ(session.state(), State::kActive);
  EXPECT_GT(furthest, 0.09F);  // it was tried
  EXPECT_LE(furthest, 0.1F + 1e-5F);
}

// The hand may be where a body appears: no force, and the limit `waiting`, until it has left.
TEST(SessionWithBodies, WaitsInsideAppearingBody) {
  const Shape ball = sphere(0.015);
  ControllerRig session;
  std::uint32_t number = 0;
  ASSERT_EQ(session.controller.add_body(ball.view(), core::normalized(to_core(kFar)), number),
            ModelStatus::kOk);
  session.activate();
  for (double z = 0.01; z <= 0.03; z += 5e-5) {  // meanwhile the ramp ends
    session.move(0.0, 0.0, z);
    session.step();
  }
  session.updates = {{number, true, {{}, {0.0F, 0.0F, 0.0175F}}, {}}};  // z 2.5 ... 32.5 mm
  session.step();
  for (double z = 0.03; z < 0.0322; z += 5e-5) {
    session.move(0.0, 0.0, z);
    const core::Output output = session.step();
    ASSERT_EQ(session.state(), State::kActive);
    ASSERT_TRUE(output.motors.is_zero()) << z;
    ASSERT_TRUE(has_limit(output, Limit::kWaiting)) << z;
  }
  core::Output output = session.step();
  for (double z = 0.0322; z < 0.034; z += 5e-5) {
    session.move(0.0, 0.0, z);
    output = session.step();
    ASSERT_TRUE(output.motors.is_zero()) << z;
  }
  EXPECT_FALSE(has_limit(output, Limit::kWaiting));
  for (double z = 0.034; z > 0.0315; z -= 5e-5) {
    session.move(0.0, 0.0, z);
    output = session.step();
  }
  EXPECT_GT(output.status.force.z, 0.3F);
  EXPECT_FALSE(has_limit(output, Limit::kWaiting));
}

TEST(SessionWithBodies, RemovesLastBodyUnderForce) {
  SessionWithBodies session({});
  const float before = session.press(2e-3).status.force.z;
  ASSERT_EQ(session.controller.remove_body(0), ModelStatus::kOk);
  EXPECT_GT(session.step().status.force.z, 0.9F * before);
  EXPECT_EQ(session.state(), State::kActive);
  session.step(core::Command::kStop);
  session.step();
  EXPECT_EQ(session.state(), State::kNoModel);
}

TEST(SessionWithBodies, ReportsTooManyReachableBodies) {
  SessionWithBodies two({isometry({0.0, 0.0, 0.0})});
  EXPECT_FALSE(has_limit(two.press(1e-3), Limit::kBodies));
  SessionWithBodies three({isometry({0.0, 0.0, 0.0}), isometry({0.0, 0.0, 0.0})});
  const core::Output crowded = three.press(1e-3);
  EXPECT_TRUE(has_limit(crowded, Limit::kBodies));
  EXPECT_TRUE(crowded.status.summary());
  EXPECT_EQ(three.state(), State::kActive);
}

// Where the gate gives less than was rendered, the bodies feel less too.
TEST(SessionWithBodies, ScalesReactionsToAppliedForce) {
  core::Configuration weak;
  weak.limits.force_max_N = 0.5F;
  weak.limits.slew_N_s = 500.0F;
  // A second plane slopes down to x = 1 mm: both hold the proxy.
  SessionWithBodies session({isometry({0.001, 0.0, 0.0}, {0.0, 0.8, 0.0})}, weak);
  const core::Status status = session.press(2e-3).status;
  EXPECT_GT(core::length(status.rendering.force), 0.8F);
  EXPECT_NEAR(core::length(status.force), 0.5F, 1e-3F);
  core::Vec3 sum{};
  for (const core::Reaction& reaction : status.reactions) {
    ASSERT_NE(reaction.body, core::kNoBody);
    sum += reaction.force_N;
  }
  EXPECT_LT(core::length(sum + status.force), 1e-3F);
}

TEST(SessionWithBodies, HasNoReactionWithoutForce) {
  ControllerRig session;  // not armed
  const core::Status status = session.press(2e-3).status;
  EXPECT_TRUE(status.rendering.in_contact);
  for (const core::Reaction& reaction : status.reactions) {
    EXPECT_EQ(reaction.body, core::kNoBody);
  }
}

TEST(SessionWithBodies, AddsBodiesOnlyWhileUnpowered) {
  SessionWithBodies session({kFar});
  std::uint32_t number = 99;
  EXPECT_EQ(session.controller.add_body(shared_plane().view(), {}, number), ModelStatus::kBusy);
  EXPECT_EQ(number, 99U);
  core::Controller bare;
  EXPECT_EQ(bare.add_body(shared_plane().view(), {}, number), ModelStatus::kNotConfigured);
}

}  // namespace
}  // namespace tactree::test
