// The handler of all traps. The timer interrupt runs the tick. All other traps are faults, which
// are recorded before a reset; the motors are off after a reset.
// Loop and memory annotations: docs/BOUND.md.

#include "platform.hpp"
#include "rv32/registers.hpp"

extern "C" {
void tactree_timer_interrupt();

// Order in which tactree_trap() stores the registers.
struct StoredRegisters {
  std::uint32_t ra;
  std::uint32_t sp;
  std::uint32_t a0_to_a7[8];
  std::uint32_t t0_to_t4[5];
};

[[noreturn, gnu::used]] void tactree_capture_fault(const StoredRegisters* stored) {
  tactree::hal::CapturedFault fault;
  __asm volatile("csrr %0, mcause" : "=r"(fault.cause));
  __asm volatile("csrr %0, mstatus" : "=r"(fault.status));
  __asm volatile("csrr %0, mtval" : "=r"(fault.address));
  __asm volatile("csrr %0, mepc" : "=r"(fault.pc));
  ++fault.cause;  // 0 is a valid mcause, but means no fault in the record
  fault.lr = stored->ra;
  fault.sp = stored->sp;
  for (std::uint32_t i = 0; i < 8; ++i) {  // bound: 8
    fault.registers[i] = stored->a0_to_a7[i];
  }
  for (std::uint32_t i = 0; i < 5; ++i) {  // bound: 5
    fault.registers[8 + i] = stored->t0_to_t4[i];
  }
  tactree::firmware::capture(fault);
}

// Stores the registers in 64 bytes below the stack pointer. If less than 512 bytes of stack are
// left (this check uses t0), the trap is recorded at the top of the stack; the handler may
// overwrite the stack because it never returns then.
[[gnu::naked, gnu::aligned(4)]] void tactree_trap() {
  __asm volatile(
      "csrw mscratch, t0\n\t"
      "la t0, image_stack_bottom + 512\n\t"
      "bltu sp, t0, 2f\n\t"
      "csrr t0, mscratch\n\t"
      "addi sp, sp, -64\n\t"
      "sw t0, 40(sp)\n\t"
      "csrr t0, mcause\n\t"
      "bgez t0, 1f\n\t"
      "lw t0, 40(sp)\n\t"
      "addi sp, sp, 64\n\t"
      "j tactree_timer_interrupt\n"
      "2:\n\t"
      "mv t0, sp\n\t"
      "la sp, image_stack_top - 64\n\t"
      "sw t0, 4(sp)\n\t"
      "csrr t0, mscratch\n\t"
      "sw t0, 40(sp)\n\t"
      "j 3f\n"
      "1:\n\t"
      "addi t0, sp, 64\n\t"
      "sw t0, 4(sp)\n"
      "3:\n\t"
      "sw ra, 0(sp)\n\t"
      "sw a0, 8(sp)\n\t"
      "sw a1, 12(sp)\n\t"
      "sw a2, 16(sp)\n\t"
      "sw a3, 20(sp)\n\t"
      "sw a4, 24(sp)\n\t"
      "sw a5, 28(sp)\n\t"
      "sw a6, 32(sp)\n\t"
      "sw a7, 36(sp)\n\t"
      "sw t1, 44(sp)\n\t"
      "sw t2, 48(sp)\n\t"
      "sw t3, 52(sp)\n\t"
      "sw t4, 56(sp)\n\t"
      "mv a0, sp\n\t"
      "j tactree_capture_fault\n\t");
}
}
