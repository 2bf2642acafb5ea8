// A stack overflow changes no variable: the core faults and records it without using the stack. The
// first run causes it, the second checks the record.

#include "expect.hpp"
#include "plant_link/semihosting.hpp"
#include "platform.hpp"
#include "runtime/image.hpp"

void tactree_tick() {}

namespace {

using tactree::firmware::semihosting::exit;
using tactree::test::expect;

volatile std::uint32_t last = 0xFFFFFFFFU;  // never reached
volatile std::uint32_t guard = 0x600DCAFE;  // one of the variables above the stack

[[gnu::noinline]] std::uint32_t descend(std::uint32_t depth) {
  volatile std::uint32_t frame[8] = {depth};
  return depth == last ? 0U : descend(depth + 1U) + frame[depth % 8U];
}

std::uint32_t place_of(const std::uint32_t* place) {
  return static_cast<std::uint32_t>(reinterpret_cast<std::uintptr_t>(place));
}

}  // namespace

int main() {
  const tactree::hal::CapturedFault fault = tactree::firmware::take_captured_fault();
  if (!fault.present()) {
    (void)descend(0);
    exit(2);
  }
  expect(guard == 0x600DCAFE, "variables are as they were");
  expect(fault.sp < place_of(image_stack_bottom) + 64U, "the stack pointer is at the stack's end");
  expect(!tactree::firmware::take_captured_fault().present(), "a fault is reported once");
  exit(0);
}
