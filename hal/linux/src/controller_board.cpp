#include "tactree/hal/linux/controller_board.hpp"

namespace tactree::hal::linux_gpio {
namespace {

// Time between kicks of the watchdog. A kick in every tick is not needed: it costs a system call,
// and timeouts are 1 s or longer.
constexpr std::uint64_t kNsPerKick = 100'000'000;

std::uint32_t ticks_per_kick(std::uint64_t period_ns) {
  const std::uint64_t ticks = kNsPerKick / period_ns;
  return ticks == 0U ? 1U : static_cast<std::uint32_t>(ticks);
}

}  // namespace

BoardEncoders::BoardEncoders(const ControllerBoardSettings& settings) {
  if (settings.counters.axes.empty()) {
    lines_.emplace(settings.encoders, settings.consumer, settings.encoder_faults_max);
  } else {
    counters_.emplace(settings.counters);
  }
}

BoardMotors::BoardMotors(const ControllerBoardSettings& settings) {
  if (settings.converters.axes.empty()) {
    pwm_.emplace(settings.motors, settings.consumer);
  } else {
    converters_.emplace(settings.converters, settings.consumer);
  }
}

ControllerBoard::ControllerBoard(const ControllerBoardSettings& settings,
                                 std::span<const std::byte> blob, session::TickMailbox& mailbox)
    : enable_line_(settings.enable, settings.enable_read_back, settings.consumer, settings.brake),
      guard_(enable_line_.line(), settings.guard),
      motors_(settings),
      safety_inputs_(settings.emergency_stop, settings.dead_man, settings.consumer),
      encoders_(settings),
      in_time_(ticks_per_kick(settings.period_ns)),
      clock_(settings.period_ns),
      ticker_(*this),
      link_{mailbox, ticker_},
      storage_(blob) {
  if (!settings.heartbeat.empty()) {
    heartbeat_.emplace(GpioLines::outputs({settings.heartbeat}, settings.consumer, false));
  }
  if (!settings.watchdog.empty()) {
    watchdog_.emplace(settings.watchdog, settings.watchdog_timeout_s);
  }
}

void ControllerBoard::stop() noexcept {
  enable_line_.set(false);
  guard_.rest();
  motors_.release();
}

void ControllerBoard::feed_watchers(bool in_time) noexcept {
  guard_.beat();
  if (heartbeat_ && in_time) {
    heartbeat_level_ = !heartbeat_level_;
    (void)heartbeat_->set(heartbeat_level_ ? 1U : 0U);
  }
  if (in_time_.is_due(in_time) && watchdog_) {
    watchdog_->kick();
  }
}

}  // namespace tactree::hal::linux_gpio
