#pragma once
// Three motors whose amplifiers have inputs for PWM and direction, on channels 1 to 3 of an
// advanced timer, centre-aligned (RM0090, sections 17.3.10 and 17.4). A pulse width takes effect
// with the next period of the timer, the direction immediately. After a change of sign the old
// width therefore acts in the new direction for up to one period, 50 us. The slew limit of the
// safety gate bounds this effort.
// Loop and memory annotations: docs/BOUND.md.
// memory: RAM

#include <cstdint>

#include "stm32f4/bits.hpp"
#include "stm32f4/pins.hpp"
#include "stm32f4/registers.hpp"
#include "tactree/core/safety/safety_gate.hpp"

namespace tactree::firmware::stm32f4 {

namespace pwm {
inline constexpr std::uint32_t kCentreAlignedOn = (1U << 0) | (1U << 5) | (1U << 7);  // CR1
inline constexpr std::uint32_t kModeOneBuffered = (0x6U << 4) | (1U << 3);            // CCMRx
inline constexpr std::uint32_t kThreeChannels = 0x111U;                               // CCER
inline constexpr std::uint32_t kHoldLowWhenOff = 1U << 10;                            // BDTR: OSSI
inline constexpr std::uint32_t kOutputsOn = 1U << 15;                                 // BDTR: MOE
inline constexpr std::uint32_t kTakeOver = 1U;                                        // EGR: UG

/// Half a PWM period in timer clocks: 168 MHz / (2 * 20 kHz). Efforts have 4200 steps; with a
/// higher frequency they would have fewer.
inline constexpr std::uint32_t kHalfPeriod = 4200;

/// Compare value of an effort, 0 .. kHalfPeriod. NaN gives 0.
inline std::uint32_t compare_of(float effort, float effort_at_full_width) {
  const float size = effort < 0.0F ? -effort : effort;
  const float share = size / effort_at_full_width;
  if (!(share > 0.0F)) {
    return 0U;
  }
  return share < 1.0F ? static_cast<std::uint32_t>(share * static_cast<float>(kHalfPeriod) + 0.5F)
                      : kHalfPeriod;
}
}  // namespace pwm

template <class Word>
class PwmMotors {
 public:
  /// `good` is high while no amplifier reports a failure; a broken wire reads low.
  PwmMotors(TimerBlock<Word>& timer, const Pin<Word> (&direction)[core::kAxes],
            const Pin<Word>& good, const float (&effort_at_full_width)[core::kAxes])
      : timer_(timer),
        direction_{direction[0], direction[1], direction[2]},
        good_(good),
        full_{effort_at_full_width[0], effort_at_full_width[1], effort_at_full_width[2]} {}

  /// Starts the timer with a duty cycle of 0 and the outputs off. Returns false if the timer does
  /// not run as configured.
  [[nodiscard]] bool start() {
    timer_.bdtr = pwm::kHoldLowWhenOff;
    timer_.psc = 0U;
    timer_.arr = pwm::kHalfPeriod;
    timer_.ccr1 = 0U;
    timer_.ccr2 = 0U;
    timer_.ccr3 = 0U;
    timer_.ccmr1 = pwm::kModeOneBuffered | (pwm::kModeOneBuffered << 8);
    timer_.ccmr2 = pwm::kModeOneBuffered;
    timer_.ccer = pwm::kThreeChannels;
    timer_.egr = pwm::kTakeOver;  // without this event the first period would use the reset values
    timer_.cr1 = pwm::kCentreAlignedOn;
    started_ = has(timer_.cr1, pwm::kCentreAlignedOn) && read(timer_.arr) == pwm::kHalfPeriod;
    return started_;
  }

  void write(const core::MotorCommand& command) noexcept {
    drive(0, timer_.ccr1, command.effort(0));
    drive(1, timer_.ccr2, command.effort(1));
    drive(2, timer_.ccr3, command.effort(2));
  }

  /// Enables or disables the outputs; disabled outputs are low. They stay disabled if the timer did
  /// not start.
  void connect(bool on) {
    connected_ = on && started_;
    // memory: flash
    change(timer_.bdtr, pwm::kOutputsOn, connected_ ? pwm::kOutputsOn : 0U);
  }

  /// True if no amplifier reports a failure and the timer's registers hold the values written.
  [[nodiscard]] bool healthy() noexcept {
    // memory: flash
    const bool delivered = read(timer_.ccr1) == compare_[0] && read(timer_.ccr2) == compare_[1] &&
                           read(timer_.ccr3) == compare_[2];
    // memory: flash
    return started_ && delivered && has(timer_.bdtr, pwm::kOutputsOn) == connected_ &&
           good_.is_high();
  }

 private:
  void drive(std::uint32_t axis, Word& compare, float effort) {
    direction_[axis].drive(effort < 0.0F);
    compare_[axis] = pwm::compare_of(effort, full_[axis]);
    compare = compare_[axis];
  }

  TimerBlock<Word>& timer_;
  Pin<Word> direction_[core::kAxes];
  Pin<Word> good_;
  float full_[core::kAxes];
  std::uint32_t compare_[core::kAxes] = {0, 0, 0};
  bool started_ = false;
  bool connected_ = false;
};

}  // namespace tactree::firmware::stm32f4
