#pragma once
// Switches the core from the internal oscillator, which runs after reset, to 168 MHz from a crystal
// (RM0090, sections 7.2 and 3.5). If a step fails, the chip runs on its internal oscillator and the
// failure is reported by name.
// Loop and memory annotations: docs/BOUND.md.

#include <cstdint>

#include "stm32f4/bits.hpp"
#include "stm32f4/registers.hpp"

namespace tactree::firmware::stm32f4 {

enum class ClockFailure : std::uint8_t {
  kNone = 0,
  kCrystal,     ///< the external oscillator does not start
  kWaitStates,  ///< the flash does not accept its wait states
  kPll,         ///< the PLL does not lock
  kSwitch,      ///< the core stays on the internal oscillator
  kFrequency,   ///< the frequency of the crystal is wrong
};

inline constexpr std::uint32_t kFullClockHz = 168000000;  ///< without a failure
inline constexpr std::uint32_t kInternalClockHz =
    16000000;  ///< after a failure; accurate to 1 % at 25 degrees C

/// Clock of the buses APB1 and APB2 at full speed; their timers run at twice this frequency
/// (section 7.2).
inline constexpr std::uint32_t kApb1Hz = kFullClockHz / 4;
inline constexpr std::uint32_t kApb2Hz = kFullClockHz / 2;

namespace rcc {
inline constexpr std::uint32_t kHseOn = 1U << 16;
inline constexpr std::uint32_t kHseReady = 1U << 17;
inline constexpr std::uint32_t kSecurityOn = 1U << 19;
inline constexpr std::uint32_t kPllOn = 1U << 24;
inline constexpr std::uint32_t kPllReady = 1U << 25;

// PLLCFGR: crystal / M = 1 MHz, * N = 336 MHz, / P = 168 MHz for the core; / Q = 48 MHz. Bits
// outside the mask are reserved and keep their value.
inline constexpr std::uint32_t kPllMask = 0x0F437FFFU;
inline constexpr std::uint32_t kPllTimes336 = 336U << 6;
inline constexpr std::uint32_t kPllFromHse = 1U << 22;
inline constexpr std::uint32_t kPllQ7 = 7U << 24;

inline constexpr std::uint32_t kSwitchMask = 0x3U;
inline constexpr std::uint32_t kSwitchPll = 0x2U;
inline constexpr std::uint32_t kSwitchedMask = 0x3U << 2;
inline constexpr std::uint32_t kSwitchedInternal = 0U;
inline constexpr std::uint32_t kSwitchedPll = 0x2U << 2;
inline constexpr std::uint32_t kRtcDivisorMask = 0x1FU << 16;
inline constexpr std::uint32_t kTim11On = 1U << 18;
inline constexpr std::uint32_t kPrescalerMask = 0xFCF0U;
inline constexpr std::uint32_t kPrescalers = (0x5U << 10) | (0x4U << 13);  // APB1 / 4, APB2 / 2

inline constexpr std::uint32_t kResetByWatchdog = 1U << 29;
inline constexpr std::uint32_t kForgetReset = 1U << 24;
}  // namespace rcc

namespace flash_access {
// Five wait states at 2.7 .. 3.6 V and 150 .. 168 MHz (table 10); prefetch and both caches.
inline constexpr std::uint32_t kMask = 0x707U;
inline constexpr std::uint32_t kFull = 0x705U;
}  // namespace flash_access

// TIM11 counts the internal oscillator and captures its count at every eighth edge of the crystal
// clock, which is divided to 1 MHz. A correct crystal gives 128 counts between two captures
// (sections 7.2.11 and 19.5).
namespace crystal_capture {
inline constexpr std::uint32_t kOfCrystal = 2U;      // OR: input of channel 1
inline constexpr std::uint32_t kEveryEighth = 0xDU;  // CCMR1
inline constexpr std::uint32_t kCaptured = 1U << 1;  // SR
inline constexpr std::uint32_t kCounts = 8U * kInternalClockHz / 1000000U;
inline constexpr std::uint32_t kCaptures = 64;
/// The internal oscillator is within 8 % from -40 to 105 degrees C (data sheet, section on its
/// characteristics), and polling may miss two of the captures (3 %).
inline constexpr std::uint32_t kTolerance = kCounts * kCaptures / 9U;
}  // namespace crystal_capture

// A poll takes about ten cycles at 16 MHz, so this limit is about 60 ms. A crystal starts in a few
// ms, and the PLL locks in 0.3 ms.
inline constexpr std::uint32_t kClockPolls = 100000;

template <class Word>
void fall_back(RccBlock<Word>& rcc_block) {
  clear(rcc_block.cfgr, rcc::kSwitchMask);
  (void)wait_until(rcc_block.cfgr, rcc::kSwitchedMask, rcc::kSwitchedInternal, kClockPolls);
  clear(rcc_block.cr, rcc::kPllOn | rcc::kHseOn);
  clear(rcc_block.cfgr, rcc::kPrescalerMask);
}

/// Counts of the internal oscillator from the first capture to the last, or 0 if a capture is
/// missing.
template <class Word>
std::uint32_t count_captures(TimerBlock<Word>& tim11) {
  std::uint32_t sum = 0;
  std::uint32_t last = 0;
  for (std::uint32_t i = 0; i <= crystal_capture::kCaptures; ++i) {  // bound: kCaptures + 1
    if (!wait_until(tim11.sr, crystal_capture::kCaptured, crystal_capture::kCaptured,
                    crystal_capture::kCounts)) {
      return 0;
    }
    const std::uint32_t now = read(tim11.ccr1);
    sum += i == 0 ? 0U : (now - last) & 0xFFFFU;
    last = now;
  }
  return sum;
}

/// True if the crystal has the frequency `crystal_MHz`. A crystal of another frequency would scale
/// the period of a tick, and thus every velocity and every limit per second. Precondition: the core
/// runs on the internal oscillator.
template <class Word>
bool has_its_frequency(RccBlock<Word>& rcc_block, TimerBlock<Word>& tim11,
                       std::uint32_t crystal_MHz) {
  change(rcc_block.cfgr, rcc::kRtcDivisorMask, crystal_MHz << 16);
  set(rcc_block.apb2enr, rcc::kTim11On);
  (void)read(rcc_block.apb2enr);
  tim11.option = crystal_capture::kOfCrystal;
  tim11.ccmr1 = crystal_capture::kEveryEighth;
  tim11.ccer = 1U;
  tim11.cr1 = 1U;
  const std::uint32_t counts = count_captures(tim11);
  tim11.cr1 = 0U;
  clear(rcc_block.apb2enr, rcc::kTim11On);
  constexpr std::uint32_t kExpected = crystal_capture::kCounts * crystal_capture::kCaptures;
  return counts >= kExpected - crystal_capture::kTolerance &&
         counts <= kExpected + crystal_capture::kTolerance;
}

template <class Word>
ClockFailure try_full_speed(RccBlock<Word>& rcc_block, FlashBlock<Word>& flash,
                            TimerBlock<Word>& tim11, std::uint32_t crystal_MHz) {
  set(rcc_block.cr, rcc::kHseOn);
  if (!wait_until(rcc_block.cr, rcc::kHseReady, rcc::kHseReady, kClockPolls)) {
    return ClockFailure::kCrystal;
  }
  if (!has_its_frequency(rcc_block, tim11, crystal_MHz)) {
    return ClockFailure::kFrequency;
  }
  // The wait states must be set and read back before the clock is raised (section 3.5.1).
  change(flash.acr, flash_access::kMask, flash_access::kFull);
  if (!wait_until(flash.acr, flash_access::kMask, flash_access::kFull, kClockPolls)) {
    return ClockFailure::kWaitStates;
  }
  change(rcc_block.cfgr, rcc::kPrescalerMask, rcc::kPrescalers);
  change(rcc_block.pllcfgr, rcc::kPllMask,
         crystal_MHz | rcc::kPllTimes336 | rcc::kPllFromHse | rcc::kPllQ7);
  set(rcc_block.cr, rcc::kPllOn);
  if (!wait_until(rcc_block.cr, rcc::kPllReady, rcc::kPllReady, kClockPolls)) {
    return ClockFailure::kPll;
  }
  change(rcc_block.cfgr, rcc::kSwitchMask, rcc::kSwitchPll);
  if (!wait_until(rcc_block.cfgr, rcc::kSwitchedMask, rcc::kSwitchedPll, kClockPolls)) {
    return ClockFailure::kSwitch;
  }
  // From here on a crystal that stops causes an NMI, which is recorded as a fault (section 7.2.7).
  set(rcc_block.cr, rcc::kSecurityOn);
  return ClockFailure::kNone;
}

/// Precondition: 4 <= crystal_MHz <= 26. Call once after a reset. The voltage scaling keeps its
/// reset value, which is the one for 168 MHz (section 5.4.1).
template <class Word>
[[nodiscard]] ClockFailure start_clocks(RccBlock<Word>& rcc_block, FlashBlock<Word>& flash,
                                        TimerBlock<Word>& tim11, std::uint32_t crystal_MHz) {
  const ClockFailure failure = try_full_speed(rcc_block, flash, tim11, crystal_MHz);
  if (failure != ClockFailure::kNone) {
    fall_back(rcc_block);
  }
  return failure;
}

/// True if the watchdog caused the last reset. Clears the flag: a second call returns false
/// (section 7.3.21).
template <class Word>
[[nodiscard]] bool take_watchdog_reset(RccBlock<Word>& rcc_block) {
  const bool by_watchdog = has(rcc_block.csr, rcc::kResetByWatchdog);
  set(rcc_block.csr, rcc::kForgetReset);
  return by_watchdog;
}

}  // namespace tactree::firmware::stm32f4
