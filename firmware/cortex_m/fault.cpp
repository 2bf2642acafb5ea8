// Any fault: writes down registers and cause, and resets. Motors are off after a reset.

#include "cortex_m/registers.hpp"
#include "platform.hpp"

namespace tactree::firmware {
namespace {

// What the core has pushed on entry, and what the handler adds below it.
struct Pushed {
  std::uint32_t r4_to_r11[8];
  std::uint32_t r0_to_r3[4];
  std::uint32_t r12;
  std::uint32_t lr;
  std::uint32_t pc;
  std::uint32_t xpsr;
};

std::uint32_t exception_number() {
  std::uint32_t number;
  __asm volatile("mrs %0, ipsr" : "=r"(number));
  return number;
}

std::uint32_t faulting_address(std::uint32_t status) {
  if ((status & cortex_m::kBusAddressValid) != 0U) {
    return cortex_m::bus_fault_address();
  }
  return (status & cortex_m::kMemoryAddressValid) != 0U ? cortex_m::memory_fault_address() : 0U;
}

}  // namespace
}  // namespace tactree::firmware

extern "C" {

[[noreturn, gnu::used]] void tactree_capture_fault(const tactree::firmware::Pushed* pushed) {
  using namespace tactree::firmware;
  tactree::hal::CapturedFault fault;
  fault.cause = exception_number();
  fault.status = cortex_m::fault_status();
  fault.address = faulting_address(fault.status);
  fault.pc = pushed->pc;
  fault.lr = pushed->lr;
  fault.sp = static_cast<std::uint32_t>(reinterpret_cast<std::uintptr_t>(pushed->r0_to_r3));
  for (std::uint32_t i = 0; i < 4; ++i) {  // bound: 4
    fault.registers[i] = pushed->r0_to_r3[i];
  }
  for (std::uint32_t i = 0; i < 8; ++i) {  // bound: 8
    fault.registers[4 + i] = pushed->r4_to_r11[i];
  }
  fault.registers[12] = pushed->r12;
  capture(fault);
}

// One stack is in use, the main one. Its pointer is handed on before a compiler touches it.
[[gnu::naked]] void tactree_fault() {
  __asm volatile(
      "push {r4-r11}\n\t"
      "mov r0, sp\n\t"
      "b tactree_capture_fault\n\t");
}
}

void tactree::firmware::reset() {
  cortex_m::synchronise();
  cortex_m::reset_control() = cortex_m::kResetKeyAndRequest;
  while (true) {  // bound: for_ever
    cortex_m::synchronise();
  }
}
