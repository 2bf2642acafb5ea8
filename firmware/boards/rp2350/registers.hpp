#pragma once
// Registers of an RP2350 that this board uses, from Raspberry Pi's data sheet of the RP2350.
// Loop and memory annotations: docs/BOUND.md.

#include <cstdint>

namespace tactree::firmware::rp2350 {

inline volatile std::uint32_t& at(std::uint32_t address) {
  return *reinterpret_cast<volatile std::uint32_t*>(address);
}

/// Polls until the bits are set. Returns false if they are not after 10^6 reads, which take longer
/// than any oscillator or PLL.
inline bool wait_for(std::uint32_t address, std::uint32_t bits) {
  constexpr std::uint32_t kPolls = 1'000'000;
  for (std::uint32_t i = 0; i < kPolls; ++i) {  // bound: kPolls
    if ((at(address) & bits) == bits) {
      return true;
    }
  }
  return false;
}

// Section 7.5: reset controller.
inline constexpr std::uint32_t kResets = 0x40020000;
inline constexpr std::uint32_t kResetDone = 0x40020008;
inline constexpr std::uint32_t kIoBank0 = 1U << 6;
inline constexpr std::uint32_t kPadsBank0 = 1U << 9;
inline constexpr std::uint32_t kPio0Block = 1U << 11;
inline constexpr std::uint32_t kPllSysBlock = 1U << 14;
inline constexpr std::uint32_t kPwmBlock = 1U << 16;

// Section 9.11: pins. Control of pin n at 8 n + 4.
inline constexpr std::uint32_t kIo = 0x40028000;
inline constexpr std::uint32_t kPads = 0x40038000;  // of pin n at 4 n + 4

// Section 3.1.11: fast access to pins.
inline constexpr std::uint32_t kPinsIn = 0xD0000004;
inline constexpr std::uint32_t kPinsSet = 0xD0000018;
inline constexpr std::uint32_t kPinsClear = 0xD0000020;
inline constexpr std::uint32_t kPinsOutput = 0xD0000038;

// Section 12.5: PWM. Slice n at 0x14 n.
inline constexpr std::uint32_t kPwmBase = 0x400A8000;
// Section 11.7: PIO 0.
inline constexpr std::uint32_t kPioBase = 0x50200000;
// Section 12.9: watchdog; section 8.5: ticks; section 7.4: power-on state machine.
inline constexpr std::uint32_t kWatchdog = 0x400D8000;
inline constexpr std::uint32_t kWatchdogTick = 0x40108030;
inline constexpr std::uint32_t kPowerOnByWatchdog = 0x40018008;
// Sections 8.1, 8.2 and 8.6: clocks, crystal oscillator, PLL.
inline constexpr std::uint32_t kClocks = 0x40010000;
inline constexpr std::uint32_t kCrystal = 0x40048000;
inline constexpr std::uint32_t kPll = 0x40050000;

}  // namespace tactree::firmware::rp2350
