#pragma once
// A board that stands alone: three encoders, three amplifiers, switches, a button and a lamp, no
// application. For chips of ST whose pins, timers and independent watchdog have the registers of
// the STM32F4; the pins are those of boards/stm32f405/README.md.
// Loop and memory annotations: docs/BOUND.md. A register may be as slow as flash.
// memory: RAM

#include <cstdint>

#include "platform.hpp"
#include "runtime/blob_area.hpp"
#include "runtime/deadline_wait.hpp"
#include "stm32f4/lines.hpp"
#include "stm32f4/pwm_motors.hpp"
#include "stm32f4/quadrature_encoders.hpp"
#include "stm32f4/watchdog.hpp"
#include "tactree/hal/board.hpp"
#include "tactree/hal/loop.hpp"
#include "tactree/hal/panel.hpp"

namespace tactree::firmware::stm32f4 {

/// The blocks in use; their clocks are enabled.
template <class Word>
struct StandAloneChip {
  GpioBlock<Word>& gpio_a;
  GpioBlock<Word>& gpio_b;
  GpioBlock<Word>& gpio_c;
  TimerBlock<Word>& tim2;
  TimerBlock<Word>& tim4;
  TimerBlock<Word>& tim5;
  TimerBlock<Word>& tim8;
  WatchdogBlock<Word>& watchdog;
};

template <class Word>
class StandAloneBoard {
 public:
  /// Refreshes the watchdog at the start of each tick and nowhere else.
  class Ticker {
   public:
    explicit Ticker(StandAloneBoard& board) : board_(board) {}
    [[nodiscard]] hal::Tick wait() noexcept {
      const std::uint32_t missed = deadline_.wait();
      board_.watchdog_.refresh();
      return {missed};
    }
    [[nodiscard]] std::uint32_t now_us() noexcept { return firmware::now_us(); }

   private:
    StandAloneBoard& board_;
    DeadlineWait deadline_;
  };

  /// healthy() also returns false if any part of the board failed to start.
  class Motors {
   public:
    explicit Motors(StandAloneBoard& board) : board_(board) {}
    void write(const core::MotorCommand& command) noexcept { board_.pwm_.write(command); }
    [[nodiscard]] bool healthy() noexcept { return board_.started_ && board_.pwm_.healthy(); }

   private:
    StandAloneBoard& board_;
  };

  /// Button and lamp in the place of an application.
  class Link {
   public:
    explicit Link(StandAloneBoard& board) : board_(board) {}
    [[nodiscard]] hal::LinkInput receive() noexcept {
      hal::LinkInput input;
      board_.panel_.operate(board_.arm_button_.is_pressed(), input);
      return input;
    }
    void send(const core::Status& status) noexcept {
      board_.lamp_.drive(board_.panel_.lamp(status));
    }

   private:
    StandAloneBoard& board_;
  };

  StandAloneBoard(const StandAloneChip<Word>& chip,
                  const float (&effort_at_full_width)[core::kAxes])
      : chip_(chip),
        encoders_({chip.tim2, CounterWidth::k32}, {chip.tim5, CounterWidth::k32},
                  {chip.tim4, CounterWidth::k16}),
        pwm_(chip.tim8, {pin_c(0), pin_c(1), pin_c(2)}, pin_b(14), effort_at_full_width),
        enable_line_(pin_c(4), pin_c(5), pwm_),
        safety_inputs_(pin_b(12), pin_b(13)),
        arm_button_(pin_b(15)),
        lamp_(pin_c(3)),
        watchdog_(chip.watchdog),
        motors_(*this),
        ticker_(*this),
        link_(*this) {}
  StandAloneBoard(const StandAloneBoard&) = delete;
  StandAloneBoard& operator=(const StandAloneBoard&) = delete;

  /// Starts every part except the watchdog. Returns the configuration for a board without an
  /// application.
  [[nodiscard]] core::Configuration start(core::Configuration configuration) {
    bool started = enable_line_.start();
    started = safety_inputs_.start() && started;
    started = arm_button_.start() && started;
    lamp_.make_output();
    prepare_encoder_pins();
    started = encoders_.start() && started;
    prepare_motor_pins();
    started_ = pwm_.start() && started;
    configuration.link.required = false;
    configuration.link.may_command = false;
    configuration.supervision.dead_man_required = true;
    panel_.configure(configuration.rate_hz);
    return configuration;
  }

  /// Starts the watchdog after the check of the model, which takes longer than its timeout.
  void report(const hal::StartResult& result) {
    started_ = watchdog_.start() && started_;
    if (result.image != hal::ImageStatus::kOk) {
      panel_.refuse_program();
    }
  }

  [[nodiscard]] QuadratureEncoders<Word>& encoders() noexcept { return encoders_; }
  [[nodiscard]] Motors& motors() noexcept { return motors_; }
  [[nodiscard]] EnableLine<Word>& enable_line() noexcept { return enable_line_; }
  [[nodiscard]] SafetyInputs<Word>& safety_inputs() noexcept { return safety_inputs_; }
  [[nodiscard]] Link& link() noexcept { return link_; }
  [[nodiscard]] const BlobArea& storage() const noexcept { return storage_; }
  [[nodiscard]] Ticker& ticker() noexcept { return ticker_; }

 private:
  // Numbers of the alternate functions, the same on the STM32F405 and the STM32H743.
  static constexpr std::uint32_t kTim2Function = 1;
  static constexpr std::uint32_t kTim4And5Function = 2;
  static constexpr std::uint32_t kTim8Function = 3;

  Pin<Word> pin_a(std::uint32_t number) const { return {chip_.gpio_a, number}; }
  Pin<Word> pin_b(std::uint32_t number) const { return {chip_.gpio_b, number}; }
  Pin<Word> pin_c(std::uint32_t number) const { return {chip_.gpio_c, number}; }

  // The pull-ups keep the level of an unconnected track constant.
  void prepare_encoder_pins() {
    pin_a(15).make_alternate(kTim2Function, Pull::kUp);
    pin_b(3).make_alternate(kTim2Function, Pull::kUp);
    pin_a(0).make_alternate(kTim4And5Function, Pull::kUp);
    pin_a(1).make_alternate(kTim4And5Function, Pull::kUp);
    pin_b(6).make_alternate(kTim4And5Function, Pull::kUp);
    pin_b(7).make_alternate(kTim4And5Function, Pull::kUp);
  }

  // The pull-downs keep the PWM inputs low while the timer does not drive them; a broken failure
  // line reads as a failure.
  void prepare_motor_pins() {
    for (std::uint32_t axis = 0; axis < core::kAxes; ++axis) {  // bound: kAxes
      pin_c(axis).make_output();
      pin_c(6U + axis).make_alternate(kTim8Function, Pull::kDown);
    }
    pin_b(14).make_input(Pull::kDown);
  }

  StandAloneChip<Word> chip_;
  QuadratureEncoders<Word> encoders_;
  PwmMotors<Word> pwm_;
  EnableLine<Word> enable_line_;
  SafetyInputs<Word> safety_inputs_;
  Button<Word> arm_button_;
  Pin<Word> lamp_;
  Watchdog<Word> watchdog_;
  hal::Panel panel_;
  BlobArea storage_;
  Motors motors_;
  Ticker ticker_;
  Link link_;
  bool started_ = false;
};

}  // namespace tactree::firmware::stm32f4
