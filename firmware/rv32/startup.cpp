// Start-up from reset to start_image(): stack, global pointer, trap handler and FPU.
// Loop and memory annotations: docs/BOUND.md.

#include "platform.hpp"
#include "runtime/image.hpp"
#include "rv32/registers.hpp"

namespace {

// Protects the 4 KiB below the stack with the PMP. On QEMU's machine they hold the end of the code
// memory, which is RAM too, so a stack overflow would not fault without this. No privilege mode may
// access these bytes until the next reset.
void guard_stack() {
  constexpr std::uint32_t kGuardBytes = 4096;
  const auto bottom =
      static_cast<std::uint32_t>(reinterpret_cast<std::uintptr_t>(image_stack_bottom));
  const std::uint32_t region =
      ((bottom - kGuardBytes) >> 2U) | ((kGuardBytes >> 3U) - 1U);  // NAPOT: section 3.7.1
  __asm volatile("csrw pmpaddr0, %0" ::"r"(region));
  __asm volatile("csrw pmpcfg0, %0" ::"r"(tactree::firmware::rv32::kNoAccessNapotLocked));
}

}  // namespace

extern "C" {
void tactree_trap();

[[noreturn, gnu::used]] void tactree_start() {
  using namespace tactree::firmware;
  __asm volatile("csrw mtvec, %0" ::"r"(tactree_trap));
  __asm volatile("csrs mstatus, %0" ::"r"(rv32::kStatusFpuInitial));
  __asm volatile("csrw fcsr, zero");
  guard_stack();
  start_image();
}

// The first instruction of the image.
[[gnu::naked, gnu::section(".start"), gnu::used]] void tactree_reset() {
  __asm volatile(
      ".option push\n\t"
      ".option norelax\n\t"
      "la gp, __global_pointer$\n\t"
      ".option pop\n\t"
      "la sp, image_stack_top\n\t"
      "j tactree_start\n\t");
}
}

void tactree::runtime::reset() {
  while (true) {  // bound: for_ever
    firmware::rv32::test_device() = firmware::rv32::kTestDeviceReset;
  }
}
