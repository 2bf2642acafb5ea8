#pragma once
// A Linux computer as the controller of a device: switches and enable line on GPIO lines, encoders
// on GPIO lines or counters, motors on PWM channels or converters, the mailbox of a session as the
// link. The constructor requests the enable line first, switched off, and starts its guard, so the
// motors have no power while the other components are set up.

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
#include "tactree/session/tick_mailbox.hpp"

namespace tactree::hal::linux_gpio {

struct ControllerBoardSettings {
  std::string consumer = "tactree";    ///< consumer name in gpioinfo
  std::vector<EncoderLines> encoders;  ///< alternative: counters
  CounterSettings counters{};
  std::uint32_t encoder_faults_max = 0;  ///< lost edges and illegal transitions allowed until reset
  MotorSettings motors{};                ///< alternative: converters
  ConverterSettings converters{};
  std::string enable;
  std::string brake = {};  ///< line that releases the brake with the power; empty: none
  std::string enable_read_back;
  std::string emergency_stop;
  std::string dead_man;
  /// Line that toggles in every tick on time. It drives a monostable that disconnects the
  /// amplifiers some ticks after the last edge. Empty: none.
  std::string heartbeat = {};
  std::string watchdog = {};  ///< device file; empty: none
  std::uint32_t watchdog_timeout_s = 2;
  std::uint64_t period_ns = 1'000'000;  ///< tick period
  GuardSettings guard{};
};

/// An EncoderBank of the kind selected by the settings.
class BoardEncoders {
 public:
  explicit BoardEncoders(const ControllerBoardSettings& settings);
  [[nodiscard]] core::EncoderReading read() noexcept {
    return lines_ ? lines_->read() : counters_->read();
  }
  /// Lost edges of all axes; always 0 for counters.
  [[nodiscard]] std::uint32_t lost() const { return lines_ ? lines_->lost() : 0U; }

 private:
  std::optional<GpioEncoderBank> lines_;
  std::optional<CounterEncoderBank> counters_;
};

/// A MotorBank of the kind selected by the settings.
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

/// A Board (board.hpp). Construct it and call stop() outside the loop. Its components are for the
/// thread of the loop only and do not throw.
class ControllerBoard {
 public:
  /// The ticker of the loop, on CLOCK_MONOTONIC. Each tick serves guard, watchdog and heartbeat.
  class BoardTicker {
   public:
    explicit BoardTicker(ControllerBoard& board) : board_(board) {}
    [[nodiscard]] Tick wait() noexcept {
      const Tick tick = board_.clock_.wait();
      board_.feed_watchers(tick.overruns == 0U);
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

  using Link = session::MailboxLink<BoardTicker>;

  /// Keeps references to `blob` and `mailbox`. Throws the exceptions of its components.
  ControllerBoard(const ControllerBoardSettings& settings, std::span<const std::byte> blob,
                  session::TickMailbox& mailbox);
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
  /// Lost edges of all axes since the start.
  [[nodiscard]] std::uint32_t edges_lost() const { return encoders_.lost(); }
  /// Call after the last tick: switches the enable line off, then sets zero efforts.
  void stop() noexcept;

 private:
  void feed_watchers(bool in_time) noexcept;

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
