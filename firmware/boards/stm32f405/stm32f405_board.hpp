#pragma once
// A board with an STM32F405, three encoders and three amplifiers: README.md here has the pins and
// tells what was run where. `Word` as in registers.hpp: the tests run this whole board on registers
// that behave as the manual says.

#include <cstdint>

#include "platform.hpp"
#include "runtime/blob_area.hpp"
#include "runtime/deadline_wait.hpp"
#include "stm32f4/clocks.hpp"
#include "stm32f4/lines.hpp"
#include "stm32f4/pwm_motors.hpp"
#include "stm32f4/quadrature_encoders.hpp"
#include "stm32f4/serial_link.hpp"
#include "stm32f4/watchdog.hpp"
#include "tactree/hal/board.hpp"
#include "wiring.hpp"

namespace tactree::firmware {

/// Full speed, and a clock for every part. To be called once after a reset, before any other part
/// of the chip is touched.
template <class Word>
[[nodiscard]] stm32f4::ClockFailure prepare_chip(const stm32f4::Chip<Word>& chip) {
  const stm32f4::ClockFailure failure =
      stm32f4::start_clocks(chip.rcc, chip.flash, chip.tim11, wiring::kCrystalMHz);
  stm32f4::set(chip.rcc.ahb1enr, wiring::kAhb1Clocks);
  stm32f4::set(chip.rcc.apb1enr, wiring::kApb1Clocks);
  stm32f4::set(chip.rcc.apb2enr, wiring::kApb2Clocks);
  (void)stm32f4::read(chip.rcc.apb2enr);  // a part may be used two cycles after its clock is on
  return failure;
}

template <class Word>
class Stm32f405Board {
 public:
  /// The watchdog is fed where a tick begins and nowhere else: a tick that hangs starves it.
  class Ticker {
   public:
    explicit Ticker(Stm32f405Board& board) : board_(board) {}
    [[nodiscard]] hal::Tick wait() noexcept {
      const std::uint32_t missed = deadline_.wait();
      board_.watchdog_.refresh();
      return {missed};
    }
    [[nodiscard]] std::uint32_t now_us() noexcept { return firmware::now_us(); }

   private:
    Stm32f405Board& board_;
    DeadlineWait deadline_;
  };

  /// The bank of motors, failing for as long as a part of the board did not start.
  class Motors {
   public:
    explicit Motors(Stm32f405Board& board) : board_(board) {}
    void write(const core::MotorCommand& command) noexcept { board_.pwm_.write(command); }
    [[nodiscard]] bool healthy() noexcept { return board_.started() && board_.pwm_.healthy(); }

   private:
    Stm32f405Board& board_;
  };

  /// `clocks`: what prepare_chip() returned.
  Stm32f405Board(const stm32f4::Chip<Word>& chip, stm32f4::ClockFailure clocks)
      : chip_(chip),
        encoders_({chip.tim2, stm32f4::CounterWidth::k32}, {chip.tim5, stm32f4::CounterWidth::k32},
                  {chip.tim4, stm32f4::CounterWidth::k16}),
        pwm_(chip.tim8, {pin_c(0), pin_c(1), pin_c(2)}, pin_b(14), wiring::kEffortAtFullWidth),
        enable_line_(pin_c(4), pin_c(5), pwm_),
        safety_inputs_(pin_b(12), pin_b(13)),
        port_(chip.usart1, chip.dma2, ring_),
        link_(port_),
        watchdog_(chip.watchdog),
        motors_(*this),
        ticker_(*this) {
    boot_.clocks = clocks;
  }
  Stm32f405Board(const Stm32f405Board&) = delete;
  Stm32f405Board& operator=(const Stm32f405Board&) = delete;

  /// Starts every part; the configuration is that of wiring.hpp.
  [[nodiscard]] core::Configuration connect(const hal::CapturedFault& last_fault) {
    boot_.reset_by_watchdog = stm32f4::take_watchdog_reset(chip_.rcc);
    boot_.last_fault = last_fault;
    note(enable_line_.start(), stm32f4::Part::kEnableLine);
    note(safety_inputs_.start(), stm32f4::Part::kSafetyInputs);
    prepare_encoder_pins();
    note(encoders_.start(), stm32f4::Part::kEncoders);
    prepare_motor_pins();
    note(pwm_.start(), stm32f4::Part::kMotors);
    pin_a(9).make_alternate(wiring::kUsart1Function, stm32f4::Pull::kUp);
    pin_a(10).make_alternate(wiring::kUsart1Function, stm32f4::Pull::kUp);
    port_.start(apb2_clock_hz(), wiring::kBaud);
    return wiring::configuration();
  }

  /// Tells over the link what started and what did not. The watchdog starts here and not in
  /// connect(): checking a large model takes longer than it waits.
  void report(const hal::StartResult& result) {
    boot_.result = result;
    note(watchdog_.start(), stm32f4::Part::kWatchdog);
    link_.tell(boot_);
  }

  [[nodiscard]] stm32f4::QuadratureEncoders<Word>& encoders() noexcept { return encoders_; }
  [[nodiscard]] Motors& motors() noexcept { return motors_; }
  [[nodiscard]] stm32f4::EnableLine<Word>& enable_line() noexcept { return enable_line_; }
  [[nodiscard]] stm32f4::SafetyInputs<Word>& safety_inputs() noexcept { return safety_inputs_; }
  [[nodiscard]] stm32f4::SerialLink<Word>& link() noexcept { return link_; }
  [[nodiscard]] const BlobArea& storage() const noexcept { return storage_; }
  [[nodiscard]] Ticker& ticker() noexcept { return ticker_; }

  /// Where DMA puts what comes in: a faked one has no other way to find it.
  [[nodiscard]] stm32f4::Ring& ring() noexcept { return ring_; }

 private:
  stm32f4::Pin<Word> pin_a(std::uint32_t number) const { return {chip_.gpio_a, number}; }
  stm32f4::Pin<Word> pin_b(std::uint32_t number) const { return {chip_.gpio_b, number}; }
  stm32f4::Pin<Word> pin_c(std::uint32_t number) const { return {chip_.gpio_c, number}; }

  // A pull-up: an open track does not flutter.
  void prepare_encoder_pins() {
    pin_a(15).make_alternate(wiring::kTim2Function, stm32f4::Pull::kUp);
    pin_b(3).make_alternate(wiring::kTim2Function, stm32f4::Pull::kUp);
    pin_a(0).make_alternate(wiring::kTim5Function, stm32f4::Pull::kUp);
    pin_a(1).make_alternate(wiring::kTim5Function, stm32f4::Pull::kUp);
    pin_b(6).make_alternate(wiring::kTim4Function, stm32f4::Pull::kUp);
    pin_b(7).make_alternate(wiring::kTim4Function, stm32f4::Pull::kUp);
  }

  // A pull-down: no pulse while the timer does not drive, none from a broken failure line.
  void prepare_motor_pins() {
    for (std::uint32_t axis = 0; axis < core::kAxes; ++axis) {  // bound: kAxes
      pin_c(axis).make_output();
      pin_c(6U + axis).make_alternate(wiring::kTim8Function, stm32f4::Pull::kDown);
    }
    pin_b(14).make_input(stm32f4::Pull::kDown);
  }

  [[nodiscard]] std::uint32_t apb2_clock_hz() const {
    return boot_.clocks == stm32f4::ClockFailure::kNone ? stm32f4::kApb2Hz
                                                        : stm32f4::kInternalClockHz;
  }

  [[nodiscard]] bool started() const {
    return boot_.clocks == stm32f4::ClockFailure::kNone && boot_.failed_parts == 0U;
  }

  void note(bool good, stm32f4::Part part) {
    if (!good) {
      boot_.failed_parts =
          static_cast<std::uint8_t>(boot_.failed_parts | static_cast<unsigned>(part));
    }
  }

  stm32f4::Chip<Word> chip_;
  stm32f4::QuadratureEncoders<Word> encoders_;
  stm32f4::PwmMotors<Word> pwm_;
  stm32f4::EnableLine<Word> enable_line_;
  stm32f4::SafetyInputs<Word> safety_inputs_;
  stm32f4::Ring ring_{};
  stm32f4::SerialPort<Word> port_;
  stm32f4::SerialLink<Word> link_;
  stm32f4::Watchdog<Word> watchdog_;
  BlobArea storage_;
  Motors motors_;
  Ticker ticker_;
  stm32f4::BootFrame boot_{};
};

}  // namespace tactree::firmware
