// The board of firmware/boards/stm32f405 operated by its button, with and without an application at
// its serial port.

#include <gtest/gtest.h>

#include "analytic_shapes.hpp"
#include "board_rig.hpp"

namespace tactree::test {
namespace {

using core::wire::ControlCode;
using core::wire::MessageKind;
using core::wire::WireStatus;

class Stm32f405Alone : public testing::Test {
 protected:
  Stm32f405Alone() { rig.program_image_model(model.bytes()); }
  ~Stm32f405Alone() override {
    FakeChip& chip = rig.chip();
    EXPECT_EQ(chip.clocks.violation + chip.serial.violation + chip.flash.violation, "");
  }

  const Shape model = sheet_below_hand();
  BoardRig rig;
};

// Power-up, home, arm, touch, stop, with the button and the dead-man control alone.
TEST_F(Stm32f405Alone, GivesForceWithoutApplication) {
  rig.link_use = firmware::wiring::LinkUse::kWatches;
  rig.application_runs = false;
  rig.boot();
  rig.run(100);
  ASSERT_TRUE(rig.arm_by_button()) << "faults " << rig.status().faults;
  EXPECT_FALSE(rig.feels()) << "in free space";
  EXPECT_TRUE(rig.touch()) << "force " << rig.status().force.z;
  EXPECT_TRUE(rig.chip().gpio_c.level(3)) << "the lamp is off";
  rig.press_button(30);
  EXPECT_EQ(rig.status().state, core::State::kIdle);
  EXPECT_EQ(rig.duty(), 0.0);
  ASSERT_TRUE(rig.status().faults == 0U);
  rig.chip().hold_dead_man(false);
  rig.press_button(1100);
  rig.chip().hold_dead_man(true);
  rig.run(500);
  EXPECT_EQ(rig.status().state, core::State::kArmed) << "starts inside the model";
  rig.lift();
  rig.run(500);
  EXPECT_EQ(rig.status().state, core::State::kActive);
  EXPECT_TRUE(rig.touch());
  rig.chip().press_stop(true);
  rig.run(2);
  EXPECT_EQ(rig.duty(), 0.0);
  EXPECT_EQ(rig.status().state, core::State::kFault);
  EXPECT_FALSE(rig.chip().gpio_c.level(4)) << "the amplifiers keep their power";
}

TEST_F(Stm32f405Alone, WatchingApplicationMayReconnect) {
  rig.link_use = firmware::wiring::LinkUse::kWatches;
  rig.boot();
  rig.run(100);
  ASSERT_TRUE(rig.arm_by_button());
  ASSERT_TRUE(rig.touch());
  core::wire::CapabilitiesReply can;
  ASSERT_TRUE(rig.ask(MessageKind::kCapabilities).read(can));
  EXPECT_TRUE(has_flag(can, core::wire::BoardFlag::kWatchOnly));
  EXPECT_EQ(rig.status().state, core::State::kActive);
  ASSERT_TRUE(rig.open(50).ok()) << "while active";
  EXPECT_TRUE(rig.feels()) << "after an application has connected";
  ASSERT_TRUE(rig.ask(MessageKind::kSubscribe, core::wire::SubscribeRequest{0x3FF, 100}).ok());
  EXPECT_EQ(rig.control(ControlCode::kArm).status, WireStatus::kWatchOnly);
  EXPECT_EQ(rig.ask(MessageKind::kSetLimits, core::wire::SetLimitsRequest{}).status,
            WireStatus::kWatchOnly);
  EXPECT_EQ(rig.flash(model.bytes()).status, WireStatus::kWatchOnly);
  EXPECT_EQ(rig.status().state, core::State::kActive);
  rig.application_runs = false;
  rig.run(2000);
  EXPECT_EQ(rig.status().state, core::State::kActive) << "faults " << rig.status().faults;
  EXPECT_TRUE(rig.feels()) << "after the application has fallen silent";
  rig.application_runs = true;
  ASSERT_TRUE(rig.open(50).ok());
  ASSERT_TRUE(rig.ask(MessageKind::kClose).ok());
  EXPECT_EQ(rig.status().state, core::State::kActive);
  EXPECT_TRUE(rig.feels()) << "after the application has closed its session";
  ASSERT_TRUE(rig.control(ControlCode::kStop).ok());
  EXPECT_EQ(rig.status().state, core::State::kIdle);
  EXPECT_EQ(rig.duty(), 0.0);
}

// The image as it is built: it needs no application, and takes one.
TEST_F(Stm32f405Alone, NeedsNoApplicationAndTakesOne) {
  rig.boot();
  EXPECT_FALSE(rig.configuration().link.required);
  rig.application_runs = false;
  rig.run(100);
  ASSERT_TRUE(rig.arm_by_button()) << "faults " << rig.status().faults;
  EXPECT_TRUE(rig.touch());
  rig.run(2000);
  EXPECT_TRUE(rig.feels()) << "faults " << rig.status().faults;
  rig.application_runs = true;
  EXPECT_EQ(rig.open().status, WireStatus::kBusy) << "operated by the button";
  EXPECT_TRUE(rig.feels());
  rig.lift();
  rig.press_button(30);
  rig.chip().hold_dead_man(false);
  ASSERT_TRUE(rig.arm()) << "by the application";
  EXPECT_TRUE(rig.touch());
  rig.application_runs = false;
  rig.run(60);
  EXPECT_EQ(rig.duty(), 0.0);
  EXPECT_EQ(rig.status().faults, core::fault_bit(core::Fault::kLinkLost));
}

// An open session requires its link, also of the button, until it is closed or silent for 10 s.
TEST_F(Stm32f405Alone, IsOperatedByItsButtonOnceSessionHasEnded) {
  rig.boot();
  ASSERT_TRUE(rig.open(50).ok());
  rig.application_runs = false;
  rig.run(1000);
  EXPECT_FALSE(rig.arm_by_button());
  EXPECT_EQ(rig.status().faults, core::fault_bit(core::Fault::kLinkLost));
  rig.chip().hold_dead_man(false);
  rig.press_button(1100);  // clears the fault
  const auto arm_again = [&] {
    rig.chip().hold_dead_man(false);
    rig.run(100);
    rig.press_button(1100);
    rig.chip().hold_dead_man(true);
    return rig.run(500).state;
  };
  rig.application_runs = true;
  ASSERT_TRUE(rig.open(50).ok());
  ASSERT_TRUE(rig.ask(MessageKind::kClose).ok());
  rig.application_runs = false;
  EXPECT_EQ(arm_again(), core::State::kActive) << "after a closed session";
  EXPECT_TRUE(rig.touch());
  rig.lift();
  rig.press_button(30);
  rig.application_runs = true;
  ASSERT_TRUE(rig.open(50).ok());
  rig.application_runs = false;
  rig.run(10100);
  EXPECT_EQ(arm_again(), core::State::kActive) << "after a silent session";
  EXPECT_TRUE(rig.touch());
}

}  // namespace
}  // namespace tactree::test
