#pragma once
// A board with an STM32F405, three encoders and three amplifiers: README.md here has the pins and
// tells what was run where.

#include <cstdint>

#include "platform.hpp"
#include "runtime/blob_area.hpp"
#include "runtime/deadline_wait.hpp"
#include "stm32f4/lines.hpp"
#include "stm32f4/pwm_motors.hpp"
#include "stm32f4/quadrature_encoders.hpp"
#include "stm32f4/serial_link.hpp"
#include "stm32f4/watchdog.hpp"
#include "tactree/hal/board.hpp"

namespace tactree::firmware {

class Stm32f405Board {
 public:
  using Word = stm32f4::HardwareWord;

  /// The watchdog is fed where a tick begins and nowhere else: a tick that hangs starves it.
  class Ticker {
   public:
    explicit Ticker(Stm32f405Board& board) : board_(board) {}
    [[nodiscard]] hal::Tick wait() noexcept;
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

  Stm32f405Board();
  Stm32f405Board(const Stm32f405Board&) = delete;
  Stm32f405Board& operator=(const Stm32f405Board&) = delete;

  /// Starts every part; the configuration is that of wiring.hpp.
  [[nodiscard]] core::Configuration connect(const hal::CapturedFault& last_fault);
  /// Tells over the link what started and what did not.
  void report(const hal::StartResult& result);

  [[nodiscard]] stm32f4::QuadratureEncoders<Word>& encoders() noexcept { return encoders_; }
  [[nodiscard]] Motors& motors() noexcept { return motors_; }
  [[nodiscard]] stm32f4::EnableLine<Word>& enable_line() noexcept { return enable_line_; }
  [[nodiscard]] stm32f4::SafetyInputs<Word>& safety_inputs() noexcept { return safety_inputs_; }
  [[nodiscard]] stm32f4::SerialLink<Word>& link() noexcept { return link_; }
  [[nodiscard]] const BlobArea& storage() const noexcept { return storage_; }
  [[nodiscard]] Ticker& ticker() noexcept { return ticker_; }

 private:
  [[nodiscard]] bool started() const;
  void note(bool good, stm32f4::Part part);

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

static_assert(hal::Board<Stm32f405Board>);

using Board = Stm32f405Board;

}  // namespace tactree::firmware
