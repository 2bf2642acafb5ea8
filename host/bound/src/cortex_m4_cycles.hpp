#pragma once
// Cycles of a Cortex-M4's instructions: Arm, "Cortex-M4 Technical Reference Manual", r0p1, tables
// "Cortex-M4 instruction set summary" (3.3.1) and "FPU instruction set" (7.2.3); the largest figure
// where there are several. A load or store never counts as hidden behind another.

#include <capstone/capstone.h>

#include "control_flow.hpp"

namespace tactree::bound {

/// Fills in cycles, stack_words and other_words.
void count_cycles(const cs_insn& decoded, Instruction& instruction);

}  // namespace tactree::bound
