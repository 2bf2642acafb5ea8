#pragma once
// Thumb-2 machine code of a function as instructions, with the effect of each on control flow.

#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "control_flow.hpp"
#include "image.hpp"

namespace tactree::wcet {

enum class InstructionKind { kPlain, kBranch, kCall, kReturn, kTable };

struct DecodedInstruction {
  Instruction instruction;
  InstructionKind kind = InstructionKind::kPlain;
  bool conditional = false;                               // may have no effect
  std::uint32_t target = 0;                               // of a branch or call
  int index_register = -1;                                // of a table
  unsigned table_entry = 0;                               // bytes
  std::optional<std::pair<int, std::uint32_t>> compared;  // register with a constant
};

/// Literal pools are skipped. Throws BoundError on an unknown instruction, an indirect call or
/// jump, and a call of an exception handler.
[[nodiscard]] std::vector<DecodedInstruction> decode(const Image& image, const Function& function);

}  // namespace tactree::wcet
