#pragma once
// The independent watchdog (RM0090, section 21.3). It has its own oscillator of 17 .. 47 kHz (data
// sheet, table 36), and only a reset stops it. The timeout may be changed while it runs.

#include <cstdint>

#include "stm32f4/bits.hpp"
#include "stm32f4/registers.hpp"

namespace tactree::firmware::stm32f4 {

namespace watchdog {
inline constexpr std::uint32_t kUnlock = 0x5555;
inline constexpr std::uint32_t kStart = 0xCCCC;
inline constexpr std::uint32_t kRefresh = 0xAAAA;
inline constexpr std::uint32_t kUpdating = 0x3U;
// An update takes five clocks of the slow oscillator, at most 0.3 ms.
inline constexpr std::uint32_t kPolls = 100000;
}  // namespace watchdog

/// Timeout of the watchdog: (reload + 1) * 4 * 2^prescaler clocks of its oscillator.
struct WatchdogTime {
  std::uint32_t prescaler = 0;  ///< 0 .. 6
  std::uint32_t reload = 0;     ///< 0 .. 4095
};

/// 3.2 ms at 47 kHz (three ticks at 1 kHz) to 8.9 ms at 17 kHz.
inline constexpr WatchdogTime kTimeOfTicks{0, 37};
/// 3.0 s at 47 kHz to 8.3 s at 17 kHz; an erase of a sector takes at most 2 s.
inline constexpr WatchdogTime kTimeOfErasing{6, 550};

template <class Word>
class Watchdog {
 public:
  explicit Watchdog(WatchdogBlock<Word>& block) : block_(block) {}

  /// Starts the watchdog, which then resets the chip unless refresh() is called every 3 ms. The
  /// timeout is set after the start, because this requires the watchdog's oscillator to run.
  /// Returns false if the timeout was not accepted.
  [[nodiscard]] bool start() {
    block_.kr = watchdog::kStart;
    return set(kTimeOfTicks);
  }

  /// Sets the timeout and restarts it. Returns false if the setting was not accepted; the timeout
  /// is then unknown, but the watchdog stays active. Cost: 0.3 ms, or 0.6 ms directly after another
  /// set().
  [[nodiscard]] bool set(const WatchdogTime& time) {
    refresh();
    if (!is_settled()) {
      return false;
    }
    block_.kr = watchdog::kUnlock;
    block_.pr = time.prescaler;
    block_.rlr = time.reload;
    const bool taken = is_settled();
    refresh();
    return taken && read(block_.pr) == time.prescaler && read(block_.rlr) == time.reload;
  }

  /// Restarts the timeout. Safe in the tick. Cost: one store.
  void refresh() { block_.kr = watchdog::kRefresh; }

 private:
  /// Returns false if an update stays pending. The registers can then be neither written nor read
  /// (section 21.4.4).
  [[nodiscard]] bool is_settled() const {
    return wait_until(block_.sr, watchdog::kUpdating, 0U, watchdog::kPolls);
  }

  WatchdogBlock<Word>& block_;
};

}  // namespace tactree::firmware::stm32f4
