#pragma once
// State of the processor at a processor fault, kept in RAM across the reset and reported at the
// next start.

#include <cstdint>

namespace tactree::hal {

struct CapturedFault {
  std::uint32_t cause = 0;    ///< 0: none. Arm: number of the exception; RISC-V: mcause + 1
  std::uint32_t status = 0;   ///< Arm: CFSR; RISC-V: mstatus
  std::uint32_t address = 0;  ///< Arm: BFAR or MMFAR, if valid by CFSR; RISC-V: mtval
  std::uint32_t pc = 0;       ///< faulting instruction, or one shortly after it
  std::uint32_t lr = 0;       ///< usually the return address of the faulting function
  std::uint32_t sp = 0;
  std::uint32_t registers[13] = {};  ///< Arm: r0-r12; RISC-V: a0-a7, t0-t4
  [[nodiscard]] bool present() const { return cause != 0U; }
};

}  // namespace tactree::hal
