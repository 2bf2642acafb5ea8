// Start of an RP2350: definition of the image for the boot ROM, copy of the program into RAM,
// clocks. Loop and memory annotations: docs/BOUND.md.

#include "board.hpp"

#include "cortex_m/registers.hpp"

namespace tactree::firmware {
namespace {

using namespace rp2350;

constexpr std::uint32_t kCrystalHz = 12'000'000;
constexpr std::uint32_t kFullClockHz = 150'000'000;
constexpr std::uint32_t kBlocks = kIoBank0 | kPadsBank0 | kPio0Block | kPllSysBlock | kPwmBlock;

// prepare_board() writes this before RAM is initialised; start-up must not clear it.
[[gnu::section(".noinit")]] std::uint32_t clock_hz;

// The smallest definition of an executable image for the Arm cores (data sheet, 5.9.5.1).
[[gnu::section(".vectors.boot"), gnu::used]] const std::uint32_t kImageDefinition[] = {
    0xFFFFDED3, 0x10210142, 0x000001FF, 0x00000000, 0xAB123579};

bool use_crystal() {
  at(kCrystal) = 0xAA0;                      // CTRL: 1 to 15 MHz
  at(kCrystal + 0x0CU) = 47;                 // STARTUP: 1 ms
  at(kCrystal) = 0xFABAA0;                   // CTRL: enabled
  if (!wait_for(kCrystal + 4U, 1U << 31)) {  // STATUS: stable
    return false;
  }
  at(kClocks + 0x30U) = 2;  // CLK_REF_CTRL: crystal
  return wait_for(kClocks + 0x38U, 1U << 2);
}

// 12 MHz * 125 / (5 * 2)
bool use_pll() {
  at(kPll + 8U) = 125;
  at(kPll) = 1;
  at(kPll + 4U) = (1U << 3) | (1U << 2);  // PWR: the output dividers are still off
  if (!wait_for(kPll, 1U << 31)) {        // CS: locked
    return false;
  }
  at(kPll + 0x0CU) = (5U << 16) | (2U << 12);
  at(kPll + 4U) = 1U << 2;
  at(kClocks + 0x3CU) = 0;  // CLK_SYS_CTRL: the reference; the auxiliary source is the PLL
  if (!wait_for(kClocks + 0x44U, 1U << 0)) {
    return false;
  }
  at(kClocks + 0x3CU) = 1;  // the auxiliary source
  return wait_for(kClocks + 0x44U, 1U << 1);
}

}  // namespace

std::uint32_t timer_clock_hz() { return clock_hz; }

// After a failed step the chip runs on; its motors stay off, because the board then has no clock of
// known speed.
void prepare_board() {
  at(kResets) = at(kResets) & ~kBlocks;
  const bool has_blocks = wait_for(kResetDone, kBlocks);
  const bool has_crystal = has_blocks && use_crystal();
  clock_hz = has_crystal && use_pll() ? kFullClockHz : kCrystalHz;
}

core::Configuration Board::connect(const hal::CapturedFault&) {
  const Pin inputs[] = {Pin(wiring::kEmergencyStop), Pin(wiring::kDeadMan), Pin(wiring::kButton)};
  bool started = clock_hz == kFullClockHz;
  for (const Pin& pin : inputs) {  // bound: 3
    pin.make_input(Pull::kUp);
    started = pin.pulls(Pull::kUp) && started;
  }
  Pin(wiring::kEnable).make_output();
  Pin(wiring::kEnableSense).make_input(Pull::kDown);
  Pin(wiring::kLamp).make_output();
  encoders_.start();
  pwm_.start();
  started_ = started;
  const core::Configuration configuration = wiring::configuration();
  panel_.configure(configuration.rate_hz);
  return configuration;
}

}  // namespace tactree::firmware

extern "C" {
// NOLINTBEGIN(readability-identifier-naming): names of the linker script
extern const std::uint32_t image_program_in_flash[];
extern std::uint32_t image_program_in_sram[];
extern const std::byte image_program_words[];  // its address is the number of words
extern std::uint32_t image_stack_bottom[];
extern const std::byte image_vectors_begin[];
// NOLINTEND(readability-identifier-naming)

[[noreturn]] void tactree_start();

// Runs in flash. Must not use variables or constants of the program, which is not yet copied.
[[noreturn, gnu::used, gnu::section(".vectors.reset")]] void tactree_reset() {
  namespace core = tactree::firmware::cortex_m;
  const auto words =
      static_cast<std::uint32_t>(reinterpret_cast<std::uintptr_t>(image_program_words));
  for (std::uint32_t i = 0; i < words; ++i) {  // bound: program_words
    static_cast<volatile std::uint32_t*>(image_program_in_sram)[i] = image_program_in_flash[i];
  }
  core::vector_table() =
      static_cast<std::uint32_t>(reinterpret_cast<std::uintptr_t>(image_vectors_begin));
  // The stack has RAM below it: its limit makes an overflow a fault.
  __asm volatile("msr msplim, %0" : : "r"(image_stack_bottom));
  core::synchronise();
  // The program is out of range of a direct call.
  __asm volatile("bx %0" : : "r"(&tactree_start));
  __builtin_unreachable();
}
}
