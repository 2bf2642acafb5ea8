// The button and the lamp of a board without an application.

#include "tactree/hal/panel.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "controller_rig.hpp"

namespace tactree::test {
namespace {

using core::Command;
using core::State;

constexpr float kRate_hz = 1000.0F;

/// A controller that is operated by a panel alone.
class PanelRig {
 public:
  explicit PanelRig(core::HomingMethod homing = core::HomingMethod::kGivenPose)
      : session(configuration(), homing) {
    panel_.configure(kRate_hz);
  }
  static core::Configuration configuration() {
    core::Configuration c;
    c.limits.ramp_s = 0.01F;
    return c;
  }

  void run(int ticks, bool pressed) {
    for (int i = 0; i < ticks; ++i) {
      const Command command = panel_.command(pressed);
      if (command != Command::kNone) {
        commands.push_back(command);
      }
      lamp = panel_.lamp(session.step(command).status);
    }
  }
  void press(int ticks) {
    run(ticks, true);
    run(50, false);
  }
  [[nodiscard]] State state() const { return session.state(); }

  ControllerRig session;
  std::vector<Command> commands;
  bool lamp = false;

 private:
  hal::Panel panel_;
};

TEST(Panel, OperatesFromPowerUpToTouch) {
  PanelRig rig;
  rig.run(100, false);
  rig.session.move(0.0, 0.0, 0.0);  // in the home pose
  rig.press(1100);
  EXPECT_TRUE(rig.session.controller.homed());
  EXPECT_EQ(rig.state(), State::kIdle);
  rig.session.move(0.0, 0.0, 0.005);
  rig.press(1100);
  EXPECT_EQ(rig.state(), State::kArmed);
  rig.session.input.dead_man = true;
  rig.run(50, false);
  EXPECT_EQ(rig.state(), State::kActive);
  EXPECT_FALSE(rig.session.press(1e-3).motors.is_zero());
  rig.press(30);
  EXPECT_EQ(rig.state(), State::kIdle);
  EXPECT_EQ(rig.commands, (std::vector{Command::kHome, Command::kArm, Command::kStop}));
  EXPECT_EQ(rig.session.controller.faults(), 0U);
}

TEST(Panel, ClearsFaultWithoutArming) {
  PanelRig rig(core::HomingMethod::kAbsolute);
  rig.run(100, false);
  rig.session.input.emergency_stop = true;
  rig.run(5, false);
  EXPECT_EQ(rig.state(), State::kFault);
  rig.press(1100);
  EXPECT_EQ(rig.state(), State::kFault) << "the cause is present";
  rig.session.input.emergency_stop = false;
  rig.press(1100);
  EXPECT_EQ(rig.state(), State::kIdle);
}

TEST(Panel, RequiresLongPressToArm) {
  PanelRig rig(core::HomingMethod::kAbsolute);
  rig.run(100, false);
  rig.press(990);
  rig.press(990);
  EXPECT_TRUE(rig.commands.empty());
  rig.press(1001);
  EXPECT_EQ(rig.state(), State::kArmed);
}

TEST(Panel, IgnoresButtonStuckAtPowerUp) {
  PanelRig rig(core::HomingMethod::kAbsolute);
  rig.run(10000, true);
  EXPECT_TRUE(rig.commands.empty());
}

TEST(Panel, CommandsOncePerPress) {
  PanelRig rig(core::HomingMethod::kAbsolute);
  rig.run(100, false);
  rig.run(10000, true);
  EXPECT_EQ(rig.commands, std::vector{Command::kArm});
  rig.run(100, false);
  rig.run(10000, true);  // stops, and does not arm again
  EXPECT_EQ(rig.commands, (std::vector{Command::kArm, Command::kStop}));
}

TEST(Panel, IgnoresBouncingContacts) {
  PanelRig rig(core::HomingMethod::kAbsolute);
  rig.run(100, false);
  rig.press(1100);
  ASSERT_EQ(rig.state(), State::kArmed);
  for (int i = 0; i < 100; ++i) {  // shorter than a press
    rig.run(10, true);
    rig.run(10, false);
  }
  EXPECT_EQ(rig.state(), State::kArmed);
}

/// The commands that replace that of the link while the button is held.
std::vector<Command> replacements(State state, Command of_link) {
  hal::Panel panel;
  panel.configure(kRate_hz);
  core::Status status;
  status.state = state;
  std::vector<Command> commands;
  for (int i = 0; i < 1200; ++i) {
    (void)panel.lamp(status);
    hal::LinkInput input{.command = of_link};
    panel.operate(i >= 50, input);
    if (input.command != of_link) {
      commands.push_back(input.command);
    }
  }
  return commands;
}

TEST(Panel, GivesPriorityToStops) {
  EXPECT_EQ(replacements(State::kIdle, Command::kNone), std::vector{Command::kArm});
  EXPECT_EQ(replacements(State::kIdle, Command::kStop), std::vector<Command>{});
  EXPECT_EQ(replacements(State::kActive, Command::kArm), std::vector{Command::kStop});
}

/// The lamp in slots of 0.1 s, as a text of # and .
std::string pattern(const core::Status& status, int slots) {
  hal::Panel panel;
  panel.configure(kRate_hz);
  std::string text;
  for (int i = 0; i < 100 * slots; ++i) {
    const bool on = panel.lamp(status);
    if (i % 100 == 50) {
      text += on ? '#' : '.';
    }
  }
  return text;
}

TEST(Panel, ShowsEachState) {
  core::Status status;
  const auto in = [&status](State state) {
    status.state = state;
    return pattern(status, 21);
  };
  EXPECT_EQ(in(State::kBoot), "#.#.................#");
  EXPECT_EQ(in(State::kNoModel), "#.#.................#");
  EXPECT_EQ(in(State::kIdle), "#.........#.........#");
  EXPECT_EQ(in(State::kArmed), "#.#.#.#.#.#.#.#.#.#.#");
  EXPECT_EQ(in(State::kActive), "#####################");
  status.faults = core::fault_bit(core::Fault::kNotFinite) | core::fault_bit(core::Fault::kSupply);
  EXPECT_EQ(in(State::kFault), "#.#.#.#...........#.#") << "code 4, the lowest";
  status.limits = core::limit_bit(core::Limit::kNotHomed);
  EXPECT_EQ(in(State::kIdle), "#####.....#####.....#");
}

}  // namespace
}  // namespace tactree::test
