// From reset to start_image(): stack, global pointer, trap handler and FPU.

#include "platform.hpp"
#include "runtime/image.hpp"
#include "rv32/registers.hpp"

extern "C" {
void tactree_trap();

[[noreturn, gnu::used]] void tactree_start() {
  using namespace tactree::firmware;
  __asm volatile("csrw mtvec, %0" ::"r"(tactree_trap));
  __asm volatile("csrs mstatus, %0" ::"r"(rv32::kStatusFpuInitial));
  __asm volatile("csrw fcsr, zero");
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

void tactree::firmware::reset() {
  while (true) {  // bound: for_ever
    rv32::test_device() = rv32::kTestDeviceReset;
  }
}
