#pragma once
// Drivers of an RP2350: pins, encoders on PIO, pulse width of amplifiers, watchdog.
// Loop and memory annotations: docs/BOUND.md. A register may be as slow as flash.
// memory: RAM

#include <cstdint>

#include "registers.hpp"
#include "tactree/core/control/controller.hpp"
#include "tactree/core/safety/safety_gate.hpp"

namespace tactree::firmware::rp2350 {

enum class Pull : std::uint32_t { kNone = 0, kDown = 1U << 2, kUp = 1U << 3 };
enum class Function : std::uint32_t { kPwm = 4, kPin = 5, kPio0 = 6 };

/// One pin. A pull-down needs a resistor of at most 8.2 kohm outside the chip: the one inside does
/// not pull a pin down that was high (erratum RP2350-E9).
class Pin {
 public:
  explicit Pin(std::uint32_t number) : number_(number) {}

  void make_input(Pull pull, Function function = Function::kPin) const {
    // memory: flash
    at(kPads + 4U * number_ + 4U) = kInput | static_cast<std::uint32_t>(pull);
    select(function);
  }
  /// An output that is low from the start.
  void make_output() const {
    drive(false);
    at(kPinsOutput) = 1U << number_;
    // memory: flash
    at(kPads + 4U * number_ + 4U) = kInput;
    select(Function::kPin);
  }
  void drive(bool high) const { at(high ? kPinsSet : kPinsClear) = 1U << number_; }

  // memory: flash
  [[nodiscard]] bool is_high() const { return (at(kPinsIn) >> number_ & 1U) != 0U; }
  [[nodiscard]] bool pulls(Pull pull) const {
    // memory: flash
    return at(kPads + 4U * number_ + 4U) == (kInput | static_cast<std::uint32_t>(pull));
  }

  /// `low`: the output is low, whatever drives it.
  void select(Function function, bool low = false) const {
    // memory: flash
    at(kIo + 8U * number_ + 4U) = static_cast<std::uint32_t>(function) | (low ? kDriveLow : 0U);
  }
  [[nodiscard]] bool is_low_by_force() const {
    // memory: flash
    return (at(kIo + 8U * number_ + 4U) & kDriveLow) == kDriveLow;
  }

 private:
  // Pad: input enabled, Schmitt trigger, 4 mA, not isolated.
  static constexpr std::uint32_t kInput = (1U << 6) | (1U << 4) | (1U << 1);
  static constexpr std::uint32_t kDriveLow = 2U << 12;  // OUTOVER

  std::uint32_t number_;
};

/// Three quadrature encoders, each on a state machine of PIO 0, with tracks at the pins `first` and
/// `first` + 1 of each. A state machine that stops delivers no count, which makes the axis invalid.
class Encoders {
 public:
  explicit Encoders(const std::uint32_t (&first)[core::kAxes])
      : first_{first[0], first[1], first[2]} {}

  void start() const {
    for (std::uint32_t i = 0; i < kProgramWords; ++i) {  // bound: kProgramWords
      at(kPioBase + 0x48U + 4U * i) = kProgram[i];
    }
    for (std::uint32_t axis = 0; axis < core::kAxes; ++axis) {  // bound: kAxes
      Pin(first_[axis]).make_input(Pull::kUp, Function::kPio0);
      Pin(first_[axis] + 1U).make_input(Pull::kUp, Function::kPio0);
      const std::uint32_t machine = kPioBase + 0xC8U + 0x18U * axis;
      at(machine) = 1U << 16;                             // CLKDIV: 1
      at(machine + 0x04U) = kWrapTop << 12 | kWrap << 7;  // EXECCTRL
      at(machine + 0x08U) = 1U << 19;                     // SHIFTCTRL: in to the left, out right
      at(machine + 0x14U) = first_[axis] << 15;           // PINCTRL: base of the inputs
      at(machine + 0x10U) = kClearCount;                  // INSTR: executed at once
      at(machine + 0x10U) = kJumpToUpdate;
    }
    at(kPioBase) = 0x7U;  // CTRL: enables the three machines
  }

  [[nodiscard]] core::EncoderReading read() noexcept {
    core::EncoderReading reading;
    for (std::uint32_t axis = 0; axis < core::kAxes; ++axis) {  // bound: kAxes
      reading.valid[axis] = take(axis, reading.counts[axis]);
    }
    return reading;
  }

 private:
  static constexpr std::uint32_t kFifo = 4;
  static constexpr std::uint32_t kPolls = 64;  // a machine delivers a count every 13 clocks

  /// Drops the older counts and waits for the next one.
  static bool take(std::uint32_t axis, std::int32_t& count) {
    const std::uint32_t is_empty = 1U << (8U + axis);
    const std::uint32_t received = kPioBase + 0x20U + 4U * axis;
    for (std::uint32_t i = 0; i < kFifo; ++i) {  // bound: kFifo
      // memory: flash
      [[maybe_unused]] const std::uint32_t older = at(received);
    }
    for (std::uint32_t i = 0; i < kPolls; ++i) {  // bound: kPolls
      // memory: flash
      if ((at(kPioBase + 4U) & is_empty) == 0U) {
        count = static_cast<std::int32_t>(at(received));  // memory: flash
        return true;
      }
    }
    return false;
  }

  // Decodes all edges of both tracks by a jump to (old state, new state), and pushes the count Y
  // after each sample. It occupies the addresses from 0, because the jump is absolute.
  static constexpr std::uint16_t kUpdate = 15;
  static constexpr std::uint16_t kDecrement = 14;
  static constexpr std::uint16_t kIncrement = 21;
  static constexpr std::uint16_t kProgram[] = {
      kUpdate, kDecrement, kIncrement, kUpdate,  // 00 to 00, 01, 10, 11
      kIncrement, kUpdate, kUpdate, kDecrement, kDecrement, kUpdate, kUpdate, kIncrement, kUpdate,
      kIncrement,        // 11 to 00, 01; the next two are 10
                         // and 11
      0x0080 | kUpdate,  // decrement: jmp y--, update
      0xA0C2,            // update:    mov isr, y
      0x8000,            //            push noblock
      0x60C2,            //            out isr, 2
      0x4002,            //            in pins, 2
      0xA0E6,            //            mov osr, isr
      0xA0A6,            //            mov pc, isr
      0xA04A,            // increment: mov y, ~y
      0x0080 | 23,       //            jmp y--, next
      0xA04A,            //            mov y, ~y
  };
  static constexpr std::uint32_t kProgramWords = sizeof(kProgram) / sizeof(kProgram[0]);
  static constexpr std::uint32_t kWrapTop = kProgramWords - 1;
  static constexpr std::uint32_t kWrap = kUpdate;
  static constexpr std::uint32_t kClearCount = 0xE040;  // set y, 0
  static constexpr std::uint32_t kJumpToUpdate = kUpdate;
  static_assert(kProgramWords == 24);

  std::uint32_t first_[core::kAxes];
};

/// Three amplifiers with inputs for pulse width, each on channel A of a slice, and direction. A
/// pulse width takes effect with the next period, 50 us; the direction immediately.
class PwmMotors {
 public:
  PwmMotors(const std::uint32_t (&width)[core::kAxes],
            const std::uint32_t (&direction)[core::kAxes], std::uint32_t good,
            const float (&effort_at_full_width)[core::kAxes])
      : width_{Pin(width[0]), Pin(width[1]), Pin(width[2])},
        slice_{width[0] / 2U, width[1] / 2U, width[2] / 2U},
        direction_{Pin(direction[0]), Pin(direction[1]), Pin(direction[2])},
        good_(good),
        full_{effort_at_full_width[0], effort_at_full_width[1], effort_at_full_width[2]} {}

  /// Starts with a width of 0 and the outputs low.
  void start() {
    good_.make_input(Pull::kDown);
    for (std::uint32_t axis = 0; axis < core::kAxes; ++axis) {  // bound: kAxes
      direction_[axis].make_output();
      width_[axis].make_output();
      at(block(axis) + kTop) = kPeriod - 1U;
      at(block(axis) + kCompare) = 0U;
      at(block(axis)) = 1U;  // CSR: enabled, counts up
    }
    connect(false);
  }

  void write(const core::MotorCommand& command) noexcept {
    for (std::uint32_t axis = 0; axis < core::kAxes; ++axis) {  // bound: kAxes
      const float effort = command.effort(axis);
      direction_[axis].drive(effort < 0.0F);
      compare_[axis] = compare_of(effort, full_[axis]);
      at(block(axis) + kCompare) = compare_[axis];
    }
  }

  void connect(bool on) {
    connected_ = on;
    for (const Pin& pin : width_) {  // bound: kAxes
      pin.select(Function::kPwm, !on);
    }
  }

  /// True if no amplifier reports a failure and the registers hold the values written.
  [[nodiscard]] bool healthy() noexcept {
    bool good = good_.is_high();
    for (std::uint32_t axis = 0; axis < core::kAxes; ++axis) {  // bound: kAxes
      // memory: flash
      good = good && at(block(axis) + kCompare) == compare_[axis] && (at(block(axis)) & 1U) != 0U;
      good = good && width_[axis].is_low_by_force() != connected_;
    }
    return good;
  }

 private:
  static constexpr std::uint32_t kCompare = 0x0C;
  static constexpr std::uint32_t kTop = 0x10;
  static constexpr std::uint32_t kPeriod = 7500;  // 20 kHz at 150 MHz

  [[nodiscard]] std::uint32_t block(std::uint32_t axis) const {
    return kPwmBase + 0x14U * slice_[axis];
  }

  /// 0 .. kPeriod. NaN gives 0.
  static std::uint32_t compare_of(float effort, float full) {
    const float share = (effort < 0.0F ? -effort : effort) / full;
    if (!(share > 0.0F)) {
      return 0U;
    }
    return share < 1.0F ? static_cast<std::uint32_t>(share * static_cast<float>(kPeriod) + 0.5F)
                        : kPeriod;
  }

  Pin width_[core::kAxes];
  std::uint32_t slice_[core::kAxes];
  Pin direction_[core::kAxes];
  Pin good_;
  float full_[core::kAxes];
  std::uint32_t compare_[core::kAxes] = {0, 0, 0};
  bool connected_ = false;
};

/// Resets the chip 4 ms after the last refresh, counted by the crystal.
class Watchdog {
 public:
  [[nodiscard]] bool start() const {
    at(kPowerOnByWatchdog) = kAllButOscillators;
    at(kWatchdogTick + 4U) = 12U;  // CYCLES of 12 MHz in a microsecond
    at(kWatchdogTick) = 1U;
    refresh();
    at(kWatchdog) = kEnable;
    return (at(kWatchdog) & kEnable) != 0U && wait_for(kWatchdogTick, 1U << 1);  // RUNNING
  }
  void refresh() const { at(kWatchdog + 4U) = 4000U; }

 private:
  static constexpr std::uint32_t kEnable = 1U << 30;
  static constexpr std::uint32_t kAllButOscillators = 0x01FFFFF3;
};

}  // namespace tactree::firmware::rp2350
