#pragma once
// What a processor fault left behind: kept in RAM over the reset, told at the next start.

#include <cstdint>

namespace tactree::hal {

struct CapturedFault {
  std::uint32_t cause = 0;    ///< 0: none. Arm: number of the exception; RISC-V: mcause + 1
  std::uint32_t status = 0;   ///< Arm: CFSR; RISC-V: mstatus
  std::uint32_t address = 0;  ///< Arm: BFAR or MMFAR, where CFSR says so; RISC-V: mtval
  std::uint32_t pc = 0;       ///< instruction that failed, or one soon after it
  std::uint32_t lr = 0;       ///< return address of the function it is in, as a rule
  std::uint32_t sp = 0;
  std::uint32_t registers[13] = {};  ///< Arm: r0-r12; RISC-V: a0-a7, t0-t4
  [[nodiscard]] bool present() const { return cause != 0U; }
};

}  // namespace tactree::hal
