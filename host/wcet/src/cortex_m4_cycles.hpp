#pragma once
// Cycles of the instructions of a Cortex-M4 from Arm, "Cortex-M4 Technical Reference Manual", r0p1,
// tables "Cortex-M4 instruction set summary" (3.3.1) and "FPU instruction set" (7.2.3). The maximum
// of a range is used. Loads and stores are not pipelined.

#include <capstone/capstone.h>

#include "control_flow.hpp"

namespace tactree::wcet {

/// Sets cycles, stack_words and other_words.
void count_cycles(const cs_insn& decoded, Instruction& instruction);

}  // namespace tactree::wcet
