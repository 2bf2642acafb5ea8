#pragma once
// Model of clock control, flash access time and the timer that captures the crystal: RM0090,
// sections 3.5.1, 7.2, 7.3 and 19.5.

#include <cstdint>
#include <string>

#include "fake_word.hpp"
#include "stm32f4/registers.hpp"

namespace tactree::test {

class FakeClocks {
 public:
  using Rcc = firmware::stm32f4::RccBlock<FakeWord>;
  using Flash = firmware::stm32f4::FlashBlock<FakeWord>;

  // Imperfections.
  std::uint32_t crystal_MHz = 25;  ///< 0: none is soldered
  bool pll_locks = true;
  bool switch_works = true;
  bool flash_takes_wait_states = true;
  std::uint32_t ready_after_polls = 20;
  double internal_MHz = 16.0;
  double soldered_MHz = 0.0;  ///< of the crystal, where it is not the one that is expected
  std::uint32_t captures_left = 0xFFFFFFFFU;

  /// Access that crashes a real chip or violates its data sheet; empty: none.
  std::string violation;

  explicit FakeClocks(Flash& flash) : flash_(flash) {
    rcc.cr.value = 0x83;  // the internal oscillator, on and ready
    rcc.pllcfgr.value = kPllReset;
    rcc.cr.on_read = [this](std::uint32_t value) { return control(value); };
    rcc.cr.on_write = [this](std::uint32_t value, std::uint32_t written) {
      polls_ = 0;
      const bool stops_itself = uses_pll() && (written & kPllOn) == 0U;
      return stops_itself ? value : written & ~(kHseReady | kPllReady);
    };
    rcc.pllcfgr.on_write = [this](std::uint32_t value, std::uint32_t written) {
      return (rcc.cr.value & kPllOn) != 0U ? value : written;
    };
    rcc.cfgr.on_read = [this](std::uint32_t value) { return switched(value); };
    rcc.cfgr.on_write = [this](std::uint32_t, std::uint32_t written) {
      polls_ = 0;
      return written & ~0xCU;
    };
    rcc.csr.on_write = [](std::uint32_t value, std::uint32_t written) {
      return (written & (1U << 24)) != 0U ? value & 0x00FFFFFFU : value;
    };
    tim11.sr.on_read = [this](std::uint32_t) { return capture(); };
    tim11.ccr1.on_read = [this](std::uint32_t value) {
      captured_ = false;
      return value;
    };
    flash_.acr.on_write = [this, inner = flash_.acr.on_write](std::uint32_t value,
                                                              std::uint32_t written) {
      const std::uint32_t taken = inner ? inner(value, written) : written;
      return flash_takes_wait_states ? taken : value;
    };
  }

  [[nodiscard]] bool uses_pll() const { return source_ == 2U; }

  /// Of the core, MHz.
  [[nodiscard]] std::uint32_t core_MHz() const {
    const std::uint32_t m = rcc.pllcfgr.value & 0x3FU;
    const std::uint32_t n = (rcc.pllcfgr.value >> 6) & 0x1FFU;
    const std::uint32_t p = 2U * (((rcc.pllcfgr.value >> 16) & 3U) + 1U);
    return !uses_pll() || m == 0U ? 16U : crystal_MHz * n / m / p;
  }
  /// Of the buses, MHz.
  [[nodiscard]] std::uint32_t apb1_MHz() const { return core_MHz() / divisor(10); }
  [[nodiscard]] std::uint32_t apb2_MHz() const { return core_MHz() / divisor(13); }
  [[nodiscard]] std::uint32_t usb_MHz() const {
    return crystal_MHz * ((rcc.pllcfgr.value >> 6) & 0x1FFU) / (rcc.pllcfgr.value & 0x3FU) /
           ((rcc.pllcfgr.value >> 24) & 0xFU);
  }

  Rcc rcc;
  firmware::stm32f4::TimerBlock<FakeWord> tim11;

  static constexpr std::uint32_t kPllReset = 0x24003010;

 private:
  static constexpr std::uint32_t kHseOn = 1U << 16, kHseReady = 1U << 17;
  static constexpr std::uint32_t kPllOn = 1U << 24, kPllReady = 1U << 25;

  [[nodiscard]] std::uint32_t divisor(std::uint32_t shift) const {
    const std::uint32_t field = (rcc.cfgr.value >> shift) & 7U;
    return field < 4U ? 1U : 2U << (field - 4U);
  }

  std::uint32_t control(std::uint32_t value) {
    ++polls_;
    const bool late = polls_ > ready_after_polls;
    if ((value & kHseOn) != 0U && crystal_MHz != 0U && (late || hse_was_ready_)) {
      hse_was_ready_ = true;
      value |= kHseReady;
    }
    if ((value & kPllOn) != 0U && late && pll_locks && pll_settings_allowed()) {
      value |= kPllReady;
    }
    rcc.cr.value = value;
    return value;
  }

  bool pll_settings_allowed() {
    const std::uint32_t m = rcc.pllcfgr.value & 0x3FU;
    const std::uint32_t n = (rcc.pllcfgr.value >> 6) & 0x1FFU;
    const bool from_crystal = (rcc.pllcfgr.value & (1U << 22)) != 0U && hse_was_ready_;
    const std::uint32_t input = m == 0U ? 0U : crystal_MHz / m;
    const bool good = from_crystal && m >= 2U && input >= 1U && input <= 2U && input * n >= 100U &&
                      input * n <= 432U;
    if (!good) {
      violation = "the multiplier's settings are outside its range";
    }
    return good;
  }

  // A new capture at each poll after the last one was read.
  std::uint32_t capture() {
    const std::uint32_t divisor = rcc.cfgr.value >> 16 & 0x1FU;
    const bool on = (rcc.apb2enr.value & (1U << 18)) != 0U && tim11.cr1.value == 1U &&
                    tim11.ccer.value == 1U && tim11.ccmr1.value == 0xDU &&
                    tim11.option.value == 2U && hse_was_ready_ && !uses_pll();
    if (on && divisor >= 2U && !captured_ && captures_left != 0U) {
      --captures_left;
      const double crystal = soldered_MHz > 0.0 ? soldered_MHz : crystal_MHz;
      time_us_ += 8.0 * divisor / crystal;
      tim11.ccr1.value = static_cast<std::uint32_t>(internal_MHz * time_us_) & 0xFFFFU;
      captured_ = true;
    }
    return captured_ ? 2U : 0U;
  }

  std::uint32_t switched(std::uint32_t value) {
    ++polls_;
    const std::uint32_t wanted = value & 3U;
    const bool ready = wanted != 2U || (rcc.cr.value & kPllReady) != 0U;
    if (polls_ > ready_after_polls && ready && switch_works && wanted != source_) {
      source_ = wanted;
      check_speeds();
    }
    rcc.cfgr.value = (value & ~0xCU) | (source_ << 2);
    return rcc.cfgr.value;
  }

  void check_speeds() {
    if (core_MHz() > 30U * ((flash_.acr.value & 7U) + 1U)) {
      violation = "the core is too fast for the flash";
    }
    if (core_MHz() > 168U || apb1_MHz() > 42U || apb2_MHz() > 84U) {
      violation = "a bus is too fast";
    }
  }

  Flash& flash_;
  std::uint32_t polls_ = 0;
  std::uint32_t source_ = 0;
  bool hse_was_ready_ = false;
  bool captured_ = false;
  double time_us_ = 4000.0;  // the count wraps during the measurement
};

}  // namespace tactree::test
