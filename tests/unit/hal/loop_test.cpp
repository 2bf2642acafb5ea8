// The loop transfers data between board and controller.

#include "tactree/hal/loop.hpp"

#include <gtest/gtest.h>

#include "analytic_shapes.hpp"
#include "tactree/hal/sim/board.hpp"

namespace tactree::test {
namespace {

using core::State;
using hal::sim::SimBoard;

class LoopTest : public ::testing::Test {
 protected:
  core::Output tick(double z = 0.01) {
    board_.sample({0.0, 0.0, z});
    return loop_.tick();
  }
  /// With absolute encoders.
  static core::Configuration homed() {
    core::Configuration configuration;
    configuration.device.homing = core::HomingMethod::kAbsolute;
    return configuration;
  }
  void activate() {
    board_.link().post(core::Command::kArm);
    for (int i = 0; i < 10; ++i) {
      tick();
    }
    board_.safety_inputs().hold_dead_man(true);
    for (int i = 0; i < 300; ++i) {
      tick();
    }
  }

  Shape shape_ = plane(0.01);
  SimBoard board_{{}, shape_.bytes()};
  core::Controller controller_;
  hal::Loop<SimBoard> loop_{board_, controller_};
};

TEST_F(LoopTest, WritesModelForceToMotors) {
  ASSERT_TRUE(loop_.start(homed()).ok());
  activate();
  ASSERT_EQ(controller_.state(), State::kActive);
  core::Output output = tick();
  for (double z = 0.01; z > -1e-3; z -= 1e-4) {
    output = tick(z);
  }
  output = tick(-1e-3);
  EXPECT_NEAR(output.motors.effort(2), 0.5F, 0.06F);
  EXPECT_EQ(board_.effort(2), static_cast<double>(output.motors.effort(2)));
  EXPECT_EQ(board_.link().last().tick, output.status.tick);
}

TEST_F(LoopTest, PassesBodyUpdatesToController) {
  ASSERT_TRUE(loop_.start(homed()).ok());
  activate();
  for (double z = 0.01; z > -1e-3; z -= 1e-4) {
    tick(z);
  }
  const core::Pose higher{{}, {0.0F, 0.0F, 1e-3F}};
  board_.link().post(core::Command::kNone);
  board_.link().attach(hal::BodyUpdate{.body = 0, .pose = higher});
  for (int i = 0; i < 10; ++i) {
    tick(-1e-3);
  }
  EXPECT_NEAR(board_.effort(2), 1.0, 0.06);
  board_.link().post(core::Command::kNone);
  board_.link().attach(hal::BodyUpdate{.body = 0, .enabled = false, .pose = higher});
  EXPECT_FALSE(tick(-1e-3).status.rendering.in_contact);
  EXPECT_FALSE(tick(-1e-3).status.rendering.in_contact);
}

// Updates of a missing body or with an invalid pose: the session continues.
TEST_F(LoopTest, IgnoresRefusedBodyUpdate) {
  ASSERT_TRUE(loop_.start(homed()).ok());
  activate();
  for (double z = 0.01; z > -1e-3; z -= 1e-4) {
    tick(z);
  }
  for (int i = 0; i < 50; ++i) {
    tick(-1e-3);
  }
  const float before = tick(-1e-3).status.force.z;
  board_.link().post(core::Command::kNone);
  board_.link().attach(hal::BodyUpdate{.body = 0, .pose = {{0.5F, {}}, {}}});
  EXPECT_NEAR(tick(-1e-3).status.force.z, before, 1e-3F);
  board_.link().post(core::Command::kNone);
  board_.link().attach(hal::BodyUpdate{.body = 7});
  EXPECT_NEAR(tick(-1e-3).status.force.z, before, 1e-3F);
  EXPECT_EQ(controller_.state(), State::kActive);
}

TEST_F(LoopTest, PowersNothingBeforeArming) {
  ASSERT_TRUE(loop_.start(homed()).ok());
  for (double z = 0.01; z > -2e-3; z -= 1e-4) {
    tick(z);
    ASSERT_FALSE(board_.enable_line().read_back());
    ASSERT_EQ(board_.effort(2), 0.0);
  }
}

TEST_F(LoopTest, ForwardsEverySwitchAndFailure) {
  const auto fault_after = [this](auto&& happen) {
    core::Controller fresh;
    hal::Loop<SimBoard> loop(board_, fresh);
    EXPECT_TRUE(loop.start(homed()).ok());
    board_.sample({0.0, 0.0, 0.01});
    loop.tick();
    EXPECT_EQ(fresh.faults(), 0U);
    happen();
    board_.sample({0.0, 0.0, 0.01});
    loop.tick();
    return fresh.faults();
  };
  EXPECT_EQ(fault_after([&] { board_.safety_inputs().press_emergency_stop(true); }),
            core::fault_bit(core::Fault::kEmergencyStop));
  board_.safety_inputs().press_emergency_stop(false);
  EXPECT_EQ(fault_after([&] { board_.ticker().miss(3); }),
            core::fault_bit(core::Fault::kDeadlineMissed));
  EXPECT_EQ(fault_after([&] { board_.motors().set_healthy(false); }),
            core::fault_bit(core::Fault::kMotorFault));
  board_.motors().set_healthy(true);
  EXPECT_EQ(fault_after([&] { board_.encoders().jump(0, 5000); }),
            core::fault_bit(core::Fault::kEncoderJump));
  EXPECT_EQ(
      fault_after([&] { board_.encoders().inject(2, hal::sim::EncoderFault::kDisconnected); }),
      core::fault_bit(core::Fault::kEncoderInvalid));
}

TEST_F(LoopTest, RefusesDamagedModel) {
  std::vector<std::byte> bytes(shape_.bytes().begin(), shape_.bytes().end());
  bytes[100] ^= std::byte{1};
  SimBoard board({}, bytes);
  core::Controller controller;
  hal::Loop<SimBoard> loop(board, controller);
  const hal::StartResult result = loop.start({});
  EXPECT_FALSE(result.ok());
  EXPECT_EQ(result.blob, core::BlobStatus::kBadChecksum);
  EXPECT_EQ(controller.state(), State::kNoModel);
  for (double z = 0.01; z > -2e-3; z -= 1e-4) {
    board.sample({0.0, 0.0, z});
    EXPECT_TRUE(loop.tick().motors.is_zero());
  }
}

TEST_F(LoopTest, RefusesBadConfiguration) {
  core::Configuration configuration;
  configuration.limits.force_max_N = -1.0F;
  const hal::StartResult result = loop_.start(configuration);
  EXPECT_EQ(result.configuration, core::ConfigurationStatus::kBadLimit);
  EXPECT_FALSE(result.ok());
  tick();
  EXPECT_EQ(controller_.state(), State::kBoot);
}

}  // namespace
}  // namespace tactree::test
