#pragma once
// The independent watchdog (RM0090, section 21.3): a clock of its own, and no way to stop it but a
// reset. Its oscillator runs at 17 .. 47 kHz (data sheet, table 36).

#include <cstdint>

#include "stm32f4/bits.hpp"
#include "stm32f4/registers.hpp"

namespace tactree::firmware::stm32f4 {

namespace watchdog {
inline constexpr std::uint32_t kUnlock = 0x5555;
inline constexpr std::uint32_t kStart = 0xCCCC;
inline constexpr std::uint32_t kRefresh = 0xAAAA;
inline constexpr std::uint32_t kDivideBy4 = 0;
/// (37 + 1) * 4 clocks: 3.2 ms at 47 kHz, which is three ticks at 1 kHz; 8.9 ms at 17 kHz.
inline constexpr std::uint32_t kReload = 37;
inline constexpr std::uint32_t kUpdating = 0x3U;
// An update takes five clocks of the slow oscillator, at most 0.3 ms.
inline constexpr std::uint32_t kPolls = 100000;
}  // namespace watchdog

template <class Word>
class Watchdog {
 public:
  explicit Watchdog(WatchdogBlock<Word>& block) : block_(block) {}

  /// From now on a reset comes unless refresh() is called every 3 ms. Starting comes first: without
  /// its oscillator the watchdog takes no settings. False: it did not take them.
  [[nodiscard]] bool start() {
    block_.kr = watchdog::kStart;
    block_.kr = watchdog::kUnlock;
    block_.pr = watchdog::kDivideBy4;
    block_.rlr = watchdog::kReload;
    const bool taken = wait_until(block_.sr, watchdog::kUpdating, 0U, watchdog::kPolls);
    refresh();
    return taken && read(block_.rlr) == watchdog::kReload;
  }

  void refresh() { block_.kr = watchdog::kRefresh; }

 private:
  WatchdogBlock<Word>& block_;
};

}  // namespace tactree::firmware::stm32f4
