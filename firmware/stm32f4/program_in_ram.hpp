#pragma once
// Reset handler of an STM32F405 whose program runs from RAM: flash has five wait states at 168 MHz
// (RM0090, table 10), SRAM none. linker/stm32f405.ld describes the memory layout. Include this file
// once per image.
// Loop and memory annotations: docs/BOUND.md.

#include <cstdint>

#include "cortex_m/registers.hpp"

extern "C" {
// NOLINTBEGIN(readability-identifier-naming): names of the linker script
extern const std::uint32_t image_program_in_flash[];
extern std::uint32_t image_program_in_sram[];
extern const std::byte image_program_words[];  // its address is the number of words
// NOLINTEND(readability-identifier-naming)

[[noreturn]] void tactree_start();

// Runs at its address in flash, because a boot loader may have mapped another memory at address 0.
// Must not use variables or constants of the program, which is not yet copied.
// NOLINTNEXTLINE(misc-definitions-in-headers): an inline one would not replace the weak default
[[noreturn, gnu::used, gnu::section(".vectors.reset")]] void tactree_reset() {
  namespace core = tactree::firmware::cortex_m;
  const auto words =
      static_cast<std::uint32_t>(reinterpret_cast<std::uintptr_t>(image_program_words));
  for (std::uint32_t i = 0; i < words; ++i) {  // bound: program_words
    static_cast<volatile std::uint32_t*>(image_program_in_sram)[i] = image_program_in_flash[i];
  }
  constexpr std::uint32_t kRccApb2Enr = 0x40023844;  // RM0090, 7.3.14
  constexpr std::uint32_t kSyscfgClock = 1U << 14U;
  constexpr std::uint32_t kSyscfgMemrmp = 0x40013800;  // RM0090, 9.2.1
  constexpr std::uint32_t kSramAtZero = 3;
  constexpr std::uint32_t kFlashBegin = 0x08000000;
  core::register_at(kRccApb2Enr) = core::register_at(kRccApb2Enr) | kSyscfgClock;
  [[maybe_unused]] const std::uint32_t enabled =
      core::register_at(kRccApb2Enr);  // usable two cycles after its clock is enabled
  core::vector_table() = kFlashBegin;
  core::register_at(kSyscfgMemrmp) = kSramAtZero;
  core::synchronise();
  // Makes the program read-only, both at address 0 and in SRAM1, where it occupies the 16 KiB
  // subregions 3 to 6. A write through a null pointer or below the stack, which begins where the
  // program ends, then faults.
  constexpr std::uint32_t kSram = 0x20000000;
  constexpr std::uint32_t kAllSectorsButProgram = 0x87;
  core::protect(0, {0x00000000, 0, true});
  core::protect(1, {kSram, kAllSectorsButProgram, false});
  core::mpu_control() = core::kMpuOnWithDefaultMap;
  core::synchronise();
  // The program is out of range of a direct call.
  asm volatile("bx %0" : : "r"(&tactree_start));
  __builtin_unreachable();
}
}
