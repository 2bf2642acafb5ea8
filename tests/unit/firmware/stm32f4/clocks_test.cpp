// From reset to 168 MHz in the order of the manual, and the fallback if a step fails.

#include "stm32f4/clocks.hpp"

#include <gtest/gtest.h>

#include "fake_clocks.hpp"

namespace tactree::test {
namespace {

using firmware::stm32f4::ClockFailure;
using firmware::stm32f4::start_clocks;

struct Chip {
  FakeClocks::Flash flash;
  FakeClocks clocks{flash};
  ClockFailure start() { return start_clocks(clocks.rcc, flash, clocks.tim11, 25); }
};

TEST(Clocks, ReachesFullSpeed) {
  Chip chip;
  EXPECT_EQ(chip.start(), ClockFailure::kNone);
  EXPECT_EQ(chip.clocks.core_MHz() * 1000000U, firmware::stm32f4::kFullClockHz);
  EXPECT_EQ(chip.clocks.apb1_MHz() * 1000000U, firmware::stm32f4::kApb1Hz);
  EXPECT_EQ(chip.clocks.apb2_MHz() * 1000000U, firmware::stm32f4::kApb2Hz);
  EXPECT_EQ(chip.clocks.usb_MHz(), 48U);
  EXPECT_EQ(chip.clocks.violation, "");
  EXPECT_NE(chip.clocks.rcc.cr.value & (1U << 19), 0U) << "a crystal that stops goes unnoticed";
}

TEST(Clocks, SupportsEveryDocumentedCrystal) {
  for (std::uint32_t crystal_MHz = 4; crystal_MHz <= 26; ++crystal_MHz) {
    Chip chip;
    chip.clocks.crystal_MHz = crystal_MHz;
    EXPECT_EQ(start_clocks(chip.clocks.rcc, chip.flash, chip.clocks.tim11, crystal_MHz),
              ClockFailure::kNone);
    EXPECT_EQ(chip.clocks.core_MHz(), 168U) << crystal_MHz;
    EXPECT_EQ(chip.clocks.violation, "");
  }
}

// Against the internal oscillator, which is good for 8 % itself.
TEST(Clocks, DetectsWrongCrystalFrequency) {
  for (const double internal_MHz : {16.0 * 0.92, 16.0, 16.0 * 1.08}) {
    Chip chip;
    chip.clocks.internal_MHz = internal_MHz;
    EXPECT_EQ(chip.start(), ClockFailure::kNone) << internal_MHz;
  }
  for (const double soldered_MHz : {8.0, 12.0, 16.0, 20.0, 22.0, 28.5}) {
    Chip chip;
    chip.clocks.soldered_MHz = soldered_MHz;
    EXPECT_EQ(chip.start(), ClockFailure::kFrequency) << soldered_MHz;
  }
}

TEST(Clocks, KeepsReservedMultiplierBits) {
  Chip chip;
  (void)chip.start();
  const std::uint32_t reserved = ~0x0F437FFFU;
  EXPECT_EQ(chip.clocks.rcc.pllcfgr.value & reserved, FakeClocks::kPllReset & reserved);
}

TEST(Clocks, FallsBackToInternalOscillator) {
  const std::pair<ClockFailure, void (*)(FakeClocks&)> cases[] = {
      {ClockFailure::kCrystal, [](FakeClocks& c) { c.crystal_MHz = 0; }},
      {ClockFailure::kFrequency, [](FakeClocks& c) { c.soldered_MHz = 8.0; }},
      {ClockFailure::kFrequency, [](FakeClocks& c) { c.captures_left = 0; }},
      {ClockFailure::kFrequency, [](FakeClocks& c) { c.captures_left = 30; }},
      {ClockFailure::kWaitStates, [](FakeClocks& c) { c.flash_takes_wait_states = false; }},
      {ClockFailure::kPll, [](FakeClocks& c) { c.pll_locks = false; }},
      {ClockFailure::kSwitch, [](FakeClocks& c) { c.switch_works = false; }},
  };
  for (const auto& [failure, break_it] : cases) {
    Chip chip;
    break_it(chip.clocks);
    EXPECT_EQ(chip.start(), failure);
    EXPECT_FALSE(chip.clocks.uses_pll());
    EXPECT_EQ(chip.clocks.core_MHz(), 16U);
    EXPECT_EQ(chip.clocks.rcc.cfgr.value & 0xFCF3U, 0U) << "buses divide, or the switch is thrown";
    EXPECT_EQ(chip.clocks.rcc.cr.value & ((1U << 24) | (1U << 16)), 0U) << "something still runs";
    EXPECT_EQ(chip.clocks.violation, "");
  }
}

TEST(Clocks, LimitsWaitForSlowCrystal) {
  Chip patient;
  patient.clocks.ready_after_polls = firmware::stm32f4::kClockPolls - 1;
  EXPECT_EQ(patient.start(), ClockFailure::kNone);
  Chip late;
  late.clocks.ready_after_polls = firmware::stm32f4::kClockPolls + 1;
  EXPECT_EQ(late.start(), ClockFailure::kCrystal);
}

TEST(Clocks, ReportsWatchdogResetOnce) {
  Chip chip;
  chip.clocks.rcc.csr.value = 1U << 29;
  EXPECT_TRUE(firmware::stm32f4::take_watchdog_reset(chip.clocks.rcc));
  EXPECT_FALSE(firmware::stm32f4::take_watchdog_reset(chip.clocks.rcc));
}

// Tests of the fake: it refuses what the chip refuses.
TEST(FakeClocks, DetectsCoreFasterThanFlash) {
  Chip chip;
  auto& rcc = chip.clocks.rcc;
  rcc.cr = 1U << 16;
  while ((rcc.cr & (1U << 17)) == 0U) {
  }
  rcc.pllcfgr = 25U | (336U << 6) | (1U << 22) | (7U << 24);
  rcc.cr = (1U << 16) | (1U << 24);
  while ((rcc.cr & (1U << 25)) == 0U) {
  }
  rcc.cfgr = 2U;
  while ((rcc.cfgr & 0xCU) == 0U) {
  }
  EXPECT_EQ(chip.clocks.violation, "a bus is too fast");
  EXPECT_EQ(chip.clocks.core_MHz(), 168U);
}

}  // namespace
}  // namespace tactree::test
