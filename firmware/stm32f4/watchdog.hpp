#pragma once
// The independent watchdog (RM0090, section 21.3): a clock of its own, and no way to stop it but a
// reset. Its oscillator runs at 17 .. 47 kHz (data sheet, table 36). How long it waits may be
// changed while it runs.

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

/// (reload + 1) * 4 * 2^prescaler clocks of its oscillator.
struct WatchdogTime {
  std::uint32_t prescaler = 0;  ///< 0 .. 6
  std::uint32_t reload = 0;     ///< 0 .. 4095
};

/// 3.2 ms at 47 kHz, which is three ticks at 1 kHz; 8.9 ms at 17 kHz.
inline constexpr WatchdogTime kTimeOfTicks{0, 37};
/// 3.0 s at 47 kHz, 8.3 s at 17 kHz: the flash erases a sector in 2 s at most.
inline constexpr WatchdogTime kTimeOfErasing{6, 550};

template <class Word>
class Watchdog {
 public:
  explicit Watchdog(WatchdogBlock<Word>& block) : block_(block) {}

  /// From now on a reset comes unless refresh() is called every 3 ms. Starting comes first: without
  /// its oscillator the watchdog takes no settings. False: it did not take them.
  [[nodiscard]] bool start() {
    block_.kr = watchdog::kStart;
    return set(kTimeOfTicks);
  }

  /// Waits so long from now on, beginning anew. False: it did not take that. What it does then is
  /// not known, but that it bites. Cost: 0.3 ms, or two times as much after another set().
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

  void refresh() { block_.kr = watchdog::kRefresh; }

 private:
  /// While a setting is on its way no other is taken, and none can be read (section 21.4.4).
  [[nodiscard]] bool is_settled() const {
    return wait_until(block_.sr, watchdog::kUpdating, 0U, watchdog::kPolls);
  }

  WatchdogBlock<Word>& block_;
};

}  // namespace tactree::firmware::stm32f4
