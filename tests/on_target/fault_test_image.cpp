// A fault is recorded, survives the reset and is reported once. The first run causes it, the second
// checks the record.

#include "expect.hpp"
#include "plant_link/semihosting.hpp"
#include "platform.hpp"

void tactree_tick() {}

namespace {

using tactree::firmware::semihosting::exit;
using tactree::test::expect;

// The instruction that no core has, with a known value in an argument register.
[[gnu::noinline]] void stumble(std::uint32_t value) {
#if defined(__riscv)
  register std::uint32_t a2 __asm("a2") = value;
  __asm volatile(".global stumbling\nstumbling:\n\t.word 0" ::"r"(a2));
#else
  register std::uint32_t r2 __asm("r2") = value;
  __asm volatile(".global stumbling\nstumbling:\n\tudf #0" ::"r"(r2));
#endif
}

#if defined(__riscv)
constexpr std::uint32_t kCause = 2 + 1;  // illegal instruction
#else
constexpr std::uint32_t kCause = 6;  // usage fault
#endif
constexpr std::uint32_t kValue = 0x600DCAFE;

}  // namespace

extern "C" const std::byte stumbling[];

int main() {
  const tactree::hal::CapturedFault fault = tactree::firmware::take_captured_fault();
  if (!fault.present()) {
    stumble(kValue);
    exit(2);
  }
  const auto place = reinterpret_cast<std::uintptr_t>(stumbling);
  expect(fault.cause == kCause, "the cause is that of an unknown instruction");
  expect(fault.pc == place, "pc is the instruction's address");
  expect(fault.registers[2] == kValue, "the third register has its value");
  expect(fault.lr != 0 && fault.sp != 0, "return address and stack are reported");
  expect(!tactree::firmware::take_captured_fault().present(), "a fault is reported once");
  exit(0);
}
