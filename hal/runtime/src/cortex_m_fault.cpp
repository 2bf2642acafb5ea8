// Fault handler. Records the registers and the cause, then resets; the motors are off after a
// reset.
// Loop and memory annotations: docs/BOUND.md.

#include "fault_registers.hpp"
#include "tactree/runtime/fault_capture.hpp"

namespace tactree::runtime {
namespace {

// Registers that the core pushes on exception entry.
struct ExceptionFrame {
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
  if ((status & kBusAddressValid) != 0U) {
    return bus_fault_address();
  }
  return (status & kMemoryAddressValid) != 0U ? memory_fault_address() : 0U;
}

}  // namespace
}  // namespace tactree::runtime

extern "C" {

// `frame` is null if the stack was full, because the core could not push its registers then.
[[noreturn, gnu::used]] void tactree_capture_fault(const std::uint32_t* r4_to_r11,
                                                   const tactree::runtime::ExceptionFrame* frame,
                                                   std::uint32_t sp) {
  tactree::hal::CapturedFault fault;
  fault.cause = tactree::runtime::exception_number();
  fault.status = tactree::runtime::fault_status();
  fault.address = tactree::runtime::faulting_address(fault.status);
  fault.sp = sp;
  for (std::uint32_t i = 0; i < 8; ++i) {  // bound: 8
    fault.registers[4 + i] = r4_to_r11[i];
  }
  if (frame != nullptr) {
    fault.pc = frame->pc;
    fault.lr = frame->lr;
    for (std::uint32_t i = 0; i < 4; ++i) {  // bound: 4
      fault.registers[i] = frame->r0_to_r3[i];
    }
    fault.registers[12] = frame->r12;
  }
  tactree::runtime::capture(fault);
}

// Entry of all faults. Passes the main stack pointer, the only one in use, before compiled code
// changes it. If less than 256 bytes of stack are left for the record, the handler continues at the
// top of the stack; it may overwrite the stack because it never returns. Both ends of the stack are
// 0 in a firmware that does not define them.
[[gnu::naked]] void tactree_fault() {
  __asm volatile(
      ".weak image_stack_bottom\n\t"
      ".weak image_stack_top\n\t"
      "mov r2, sp\n\t"
      "mov r1, sp\n\t"
      "ldr r3, =image_stack_bottom\n\t"
      "cmp r2, r3\n\t"
      "it lo\n\t"
      "movlo r1, #0\n\t"
      "ldr r3, =image_stack_bottom + 256\n\t"
      "cmp r2, r3\n\t"
      "bhs 1f\n\t"
      "ldr r3, =image_stack_top\n\t"
      "mov sp, r3\n"
      "1:\n\t"
      "push {r4-r11}\n\t"
      "mov r0, sp\n\t"
      "b tactree_capture_fault\n\t"
      ".ltorg\n\t");
}
}

void tactree::runtime::reset() {
  synchronise();
  reset_control() = kResetKeyAndRequest;
  while (true) {  // bound: for_ever
    synchronise();
  }
}
