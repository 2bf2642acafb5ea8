#pragma once
// Operation at the device, without an application: one button and one lamp. For a board whose link
// is optional. The dead-man control and the emergency stop are separate (hal::SafetyInputs).
//
// The button commands, depending on the state:
//   idle, not homed      held for 1 s: home. The device is in its home pose.
//   idle, homed          held for 1 s: arm. The dead-man control then confirms.
//   armed, active        pressed: stop
//   fault                held for 1 s: clear the fault and return to idle
// It commands once for each press. A button that is pressed at power-up has no effect until it was
// released. Configuration::supervision.dead_man_required must be true: the button does not confirm.
//
// The lamp shows the state, in slots of 0.1 s:
//   boot, no model       two flashes every 2 s; three: the program or the RAM failed its self-test
//   idle, not homed      1 s period, half on
//   idle, homed          a flash every second: ready to arm
//   armed                0.2 s period: waits for the dead-man control
//   active               on
//   fault                as many flashes as the code of the fault, then a pause of 1 s
//
// Interrupt safety: no shared state; called by the tick only. Cost of each function: constant,
// about 40 instructions.
// Loop and memory annotations: docs/BOUND.md.
// memory: RAM

#include <cstdint>

#include "tactree/core/control/controller.hpp"
#include "tactree/hal/board.hpp"

namespace tactree::hal {

class Panel {
 public:
  /// Precondition: 100 <= rate_hz <= 20000.
  void configure(float rate_hz) {
    slot_ticks_ = static_cast<std::uint32_t>(kSlot_s * rate_hz);
    debounce_ticks_ = slot_ticks_ / kDebouncesPerSlot;
    hold_ticks_ = kHoldSlots * slot_ticks_;
  }

  /// For a program that failed its self-test: the lamp says so.
  void refuse_program() { flashes_without_model_ = 3; }

  /// Call once per tick, with the state of the button; returns its command.
  [[nodiscard]] core::Command command(bool pressed) {
    if (follow_up_ != core::Command::kNone) {
      const core::Command command = follow_up_;
      follow_up_ = core::Command::kNone;
      return command;
    }
    if (!pressed) {
      pressed_ticks_ = 0;
      released_ticks_ += released_ticks_ < debounce_ticks_ ? 1U : 0U;
      ready_ = ready_ || released_ticks_ >= debounce_ticks_;
      return core::Command::kNone;
    }
    released_ticks_ = 0;
    pressed_ticks_ += pressed_ticks_ < hold_ticks_ ? 1U : 0U;
    const bool powered = state_ == core::State::kArmed || state_ == core::State::kActive;
    if (!ready_ || pressed_ticks_ < (powered ? debounce_ticks_ : hold_ticks_)) {
      return core::Command::kNone;
    }
    ready_ = false;
    return command_of_press(powered);
  }

  /// Call once per tick, with the state of the button: adds its command to the input of the board's
  /// link. A stop of either has priority over the other's command.
  void operate(bool pressed, LinkInput& input) {
    const core::Command own = command(pressed);
    if (input.command == core::Command::kNone || own == core::Command::kStop) {
      input.command = own;
    }
  }

  /// Call once per tick with its status; returns whether the lamp is on.
  [[nodiscard]] bool lamp(const core::Status& status) {
    const bool homed = (status.limits & core::limit_bit(core::Limit::kNotHomed)) == 0U;
    if (status.state != state_ || homed != homed_) {
      slot_ = 0;
      ticks_in_slot_ = 0;
    }
    state_ = status.state;
    homed_ = homed;
    if (++ticks_in_slot_ > slot_ticks_) {
      ticks_in_slot_ = 1;
      ++slot_;
    }
    return is_lit(status.faults);
  }

 private:
  // Flashes of 0.1 s, not more than 5 in a second, so that a person can count them.
  static constexpr float kSlot_s = 0.1F;
  static constexpr std::uint32_t kDebouncesPerSlot = 5;  // contacts bounce for up to 10 ms
  static constexpr std::uint32_t kHoldSlots = 10;        // longer than any accidental touch
  /// Pause after the flashes of a fault code: ten times the gap between two flashes, so that two
  /// codes are not read as one.
  static constexpr std::uint32_t kPauseSlots = 10;

  [[nodiscard]] core::Command command_of_press(bool powered) {
    if (powered) {
      return core::Command::kStop;
    }
    if (state_ == core::State::kFault) {
      follow_up_ = core::Command::kStop;
      return core::Command::kClearFault;
    }
    if (state_ != core::State::kIdle) {
      return core::Command::kNone;
    }
    return homed_ ? core::Command::kArm : core::Command::kHome;
  }

  [[nodiscard]] bool is_lit(core::FaultMask faults) const {
    std::uint32_t flashes = flashes_without_model_;
    std::uint32_t period = 20;
    if (state_ == core::State::kActive) {
      return true;
    }
    if (state_ == core::State::kArmed) {
      flashes = 1;
      period = 2;
    } else if (state_ == core::State::kIdle) {
      flashes = 1;
      period = 10;
    } else if (state_ == core::State::kFault && faults != 0U) {
      flashes = static_cast<std::uint32_t>(__builtin_ctz(faults));  // the lowest code
      period = 2U * flashes + kPauseSlots;
    }
    const std::uint32_t slot = slot_ % period;
    if (state_ == core::State::kIdle && !homed_) {
      return slot < period / 2U;
    }
    return slot < 2U * flashes && slot % 2U == 0U;
  }

  std::uint32_t slot_ticks_ = 100;
  std::uint32_t debounce_ticks_ = 20;
  std::uint32_t hold_ticks_ = 1000;
  std::uint32_t pressed_ticks_ = 0;   // up to hold_ticks_
  std::uint32_t released_ticks_ = 0;  // up to debounce_ticks_
  std::uint32_t ticks_in_slot_ = 0;
  std::uint32_t slot_ = 0;
  std::uint32_t flashes_without_model_ = 2;
  core::State state_ = core::State::kBoot;
  core::Command follow_up_ = core::Command::kNone;
  bool homed_ = false;
  bool ready_ = false;  // released since the last command
};

}  // namespace tactree::hal
