#pragma once
// A Linux computer as the controller of a device: switches and enable line at GPIO lines, encoders
// there or at counters, motors at PWM channels or converters, a session's mailbox as the link. Its
// parts are requested in the order in which they can do harm: the enable line first, off, and its
// guard.

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "tactree/hal/linux/absolute_ticker.hpp"
#include "tactree/hal/linux/converter_motors.hpp"
#include "tactree/hal/linux/counter_encoders.hpp"
#include "tactree/hal/linux/enable_guard.hpp"
#include "tactree/hal/linux/gpio_board.hpp"
#include "tactree/hal/linux/pwm_motors.hpp"
#include "tactree/hal/linux/watchdog.hpp"
#include "tactree/hal/session/tick_mailbox.hpp"

namespace tactree::hal::linux_gpio {

struct ControllerBoardSettings {
  std::string consumer = "tactree";    ///< what gpioinfo shows
  std::vector<EncoderLines> encoders;  ///< these, or counters
  CounterSettings counters{};
  std::uint32_t encoder_faults_max = 0;  ///< edges lost and illegal transitions, until reset
  MotorSettings motors{};                ///< these, or converters
  ConverterSettings converters{};
  std::string enable;
  std::string brake = {};  ///< opened with the power; empty: there is none
  std::string enable_read_back;
  std::string emergency_stop;
  std::string dead_man;
  /// Changes its level with every tick in time, for a monostable that holds the amplifiers' power
  /// no longer than some ticks; empty: there is none.
  std::string heartbeat = {};
  std::string watchdog = {};  ///< its device file; empty: none
  std::uint32_t watchdog_timeout_s = 2;
  std::uint64_t period_ns = 1'000'000;  ///< of a tick
  GuardSettings guard{};
};

/// An EncoderBank of the kind that the settings name.
class BoardEncoders {
 public:
  explicit BoardEncoders(const ControllerBoardSettings& settings);
  [[nodiscard]] core::EncoderReading read() noexcept {
    return lines_ ? lines_->read() : counters_->read();
  }
  /// Edges, over all axes; counters lose none.
  [[nodiscard]] std::uint32_t lost() const { return lines_ ? lines_->lost() : 0U; }

 private:
  std::optional<GpioEncoderBank> lines_;
  std::optional<CounterEncoderBank> counters_;
};

/// A MotorBank of the kind that the settings name.
class BoardMotors {
 public:
  explicit BoardMotors(const ControllerBoardSettings& settings);
  void write(const core::MotorCommand& command) noexcept {
    pwm_ ? pwm_->write(command) : converters_->write(command);
  }
  [[nodiscard]] bool healthy() noexcept { return pwm_ ? pwm_->healthy() : converters_->healthy(); }
  void release() noexcept { pwm_ ? pwm_->release() : converters_->release(); }

 private:
  std::optional<PwmMotors> pwm_;
  std::optional<ConverterMotors> converters_;
};

class ControllerBoard {
 public:
  /// The beat of the loop: that of the computer's clock, told to whoever watches over the loop.
  class BoardTicker {
   public:
    explicit BoardTicker(ControllerBoard& board) : board_(board) {}
    [[nodiscard]] Tick wait() noexcept {
      const Tick tick = board_.clock_.wait();
      board_.tell_watchers(tick.overruns == 0U);
      return tick;
    }
    [[nodiscard]] std::uint32_t now_us() noexcept { return board_.clock_.now_us(); }

   private:
    ControllerBoard& board_;
  };

  class Storage {
   public:
    explicit Storage(std::span<const std::byte> bytes) : bytes_(bytes) {}
    [[nodiscard]] std::span<const std::byte> active() const noexcept { return bytes_; }

   private:
    std::span<const std::byte> bytes_;
  };

  using Link = MailboxLink<BoardTicker>;

  /// `blob` and `mailbox` are kept by reference. Throws what its parts throw.
  ControllerBoard(const ControllerBoardSettings& settings, std::span<const std::byte> blob,
                  TickMailbox& mailbox);
  ~ControllerBoard() { stop(); }
  ControllerBoard(const ControllerBoard&) = delete;
  ControllerBoard& operator=(const ControllerBoard&) = delete;

  [[nodiscard]] BoardEncoders& encoders() noexcept { return encoders_; }
  [[nodiscard]] BoardMotors& motors() noexcept { return motors_; }
  [[nodiscard]] GpioEnableLine& enable_line() noexcept { return enable_line_; }
  [[nodiscard]] GpioSafetyInputs& safety_inputs() noexcept { return safety_inputs_; }
  [[nodiscard]] BoardTicker& ticker() noexcept { return ticker_; }
  [[nodiscard]] Link& link() noexcept { return link_; }
  [[nodiscard]] const Storage& storage() const noexcept { return storage_; }

  [[nodiscard]] const linux_time::AbsoluteTicker& clock() const { return clock_; }
  /// Since the start, over all axes.
  [[nodiscard]] std::uint32_t edges_lost() const { return encoders_.lost(); }
  /// No more ticks will come: enable line off, then the motors.
  void stop() noexcept;

 private:
  void tell_watchers(bool in_time) noexcept;

  GpioEnableLine enable_line_;
  EnableGuard guard_;
  BoardMotors motors_;
  GpioSafetyInputs safety_inputs_;
  BoardEncoders encoders_;
  std::optional<GpioLines> heartbeat_;
  bool heartbeat_level_ = false;
  std::optional<WatchdogDevice> watchdog_;
  InTimeCounter in_time_;
  linux_time::AbsoluteTicker clock_;
  BoardTicker ticker_;
  Link link_;
  Storage storage_;
};

static_assert(Board<ControllerBoard>);

}  // namespace tactree::hal::linux_gpio
