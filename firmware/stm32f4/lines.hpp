#pragma once
// Lines of the user and of safety: enable line with read-back, emergency stop, dead-man control,
// push button. A broken wire reads as the safe state.
// Loop and memory annotations: docs/BOUND.md.
// memory: RAM

#include "stm32f4/pins.hpp"
#include "stm32f4/pwm_motors.hpp"

namespace tactree::firmware::stm32f4 {

/// Switches the power of the amplifiers and the PWM outputs. `sense` is high while the amplifiers
/// have power.
template <class Word>
class EnableLine {
 public:
  EnableLine(const Pin<Word>& line, const Pin<Word>& sense, PwmMotors<Word>& motors)
      : line_(line), sense_(sense), motors_(motors) {}

  /// Returns false if a pin did not accept its mode.
  [[nodiscard]] bool start() {
    line_.make_output();
    sense_.make_input(Pull::kDown);
    return line_.is(PinMode::kOutput) && sense_.is(PinMode::kInput) && sense_.pulls(Pull::kDown);
  }

  /// Safe in the tick. Constant cost.
  void set(bool on) noexcept {
    motors_.connect(on);
    line_.drive(on);
  }
  [[nodiscard]] bool read_back() noexcept { return sense_.is_high(); }

 private:
  Pin<Word> line_;
  Pin<Word> sense_;
  PwmMotors<Word>& motors_;
};

/// Both switches connect to ground. The emergency stop is normally closed, the dead-man control
/// normally open.
template <class Word>
class SafetyInputs {
 public:
  SafetyInputs(const Pin<Word>& stop, const Pin<Word>& dead_man)
      : stop_(stop), dead_man_(dead_man) {}

  /// Returns false if the port did not accept its settings. Both inputs then read as the safe state
  /// until the next reset. Without this check, a port without a clock would read as zero: emergency
  /// stop released and dead-man control held.
  [[nodiscard]] bool start() {
    stop_.make_input(Pull::kUp);
    dead_man_.make_input(Pull::kUp);
    trusted_ = stop_.pulls(Pull::kUp) && dead_man_.pulls(Pull::kUp);
    return trusted_;
  }

  [[nodiscard]] bool emergency_stop() noexcept { return !trusted_ || stop_.is_high(); }
  [[nodiscard]] bool dead_man() noexcept { return trusted_ && !dead_man_.is_high(); }

 private:
  Pin<Word> stop_;
  Pin<Word> dead_man_;
  bool trusted_ = false;
};

/// A push button that connects to ground. A broken wire reads as released.
template <class Word>
class Button {
 public:
  explicit Button(const Pin<Word>& pin) : pin_(pin) {}

  /// Returns false if the port did not accept its settings. The button then reads as released until
  /// the next reset.
  [[nodiscard]] bool start() {
    pin_.make_input(Pull::kUp);
    trusted_ = pin_.pulls(Pull::kUp);
    return trusted_;
  }
  [[nodiscard]] bool is_pressed() noexcept { return trusted_ && !pin_.is_high(); }

 private:
  Pin<Word> pin_;
  bool trusted_ = false;
};

}  // namespace tactree::firmware::stm32f4
