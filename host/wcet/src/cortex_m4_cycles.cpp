#include "cortex_m4_cycles.hpp"

#include <string_view>

namespace tactree::wcet {
namespace {

// Pipeline refill after a jump.
constexpr std::uint32_t kRefill = 3;

bool is_register(const cs_arm_op& operand) { return operand.type == ARM_OP_REG; }

/// Words of the registers in an operand list: one each, two for a double register.
std::uint32_t words_of(const cs_arm& arm, unsigned first) {
  std::uint32_t words = 0;
  for (unsigned i = first; i < arm.op_count; ++i) {
    const bool is_double = is_register(arm.operands[i]) && arm.operands[i].reg >= ARM_REG_D0 &&
                           arm.operands[i].reg <= ARM_REG_D31;
    words += is_register(arm.operands[i]) ? (is_double ? 2U : 1U) : 0U;
  }
  return words;
}

bool writes_pc(const cs_arm& arm) {
  for (unsigned i = 0; i < arm.op_count; ++i) {
    if (is_register(arm.operands[i]) && arm.operands[i].reg == ARM_REG_PC) {
      return true;
    }
  }
  return false;
}

bool is_any_of(std::string_view name, std::initializer_list<std::string_view> begins) {
  for (const std::string_view begin : begins) {
    if (name.starts_with(begin)) {
      return true;
    }
  }
  return false;
}

/// push, pop, ldm, stm, vldm, vstm, vpush, vpop: one cycle, and one for each word.
bool count_multiple(std::string_view name, const cs_arm& arm, Instruction& instruction) {
  const bool on_stack = is_any_of(name, {"push", "pop", "vpush", "vpop"});
  if (!on_stack && !is_any_of(name, {"ldm", "stm", "vldm", "vstm"})) {
    return false;
  }
  const std::uint32_t words = words_of(arm, on_stack ? 0 : 1);
  const bool sp = on_stack || (is_register(arm.operands[0]) && arm.operands[0].reg == ARM_REG_SP);
  (sp ? instruction.stack_words : instruction.other_words) = words;
  instruction.cycles = 1 + words + (writes_pc(arm) ? kRefill : 0U);
  return true;
}

/// ldr, str, vldr, vstr: two cycles for one word and three for two words. However, "STR
/// Rx,[Ry,#imm] is always one cycle" (Arm 100166, 3.3.2), because the word goes through a buffer.
bool count_single(std::string_view name, const cs_arm& arm, Instruction& instruction) {
  if (!is_any_of(name, {"ldr", "str", "vldr", "vstr"})) {
    return false;
  }
  std::uint32_t words = is_any_of(name, {"ldrd", "strd"}) ? 2 : words_of(arm, 0);
  bool sp = false;
  bool plain = !arm.writeback;  // an address with an immediate offset, or none
  for (unsigned i = 0; i < arm.op_count; ++i) {
    if (arm.operands[i].type == ARM_OP_MEM) {
      sp = arm.operands[i].mem.base == ARM_REG_SP;
      instruction.literal = arm.operands[i].mem.base == ARM_REG_PC;
      plain = plain && arm.operands[i].mem.index == ARM_REG_INVALID;
    }
  }
  words = words == 0 ? 1 : words;
  (sp ? instruction.stack_words : instruction.other_words) = words;
  const bool buffered = name.starts_with("str") && words == 1 && plain;
  instruction.cycles = buffered ? 1U : 1 + words + (writes_pc(arm) ? kRefill : 0U);
  return true;
}

std::uint32_t of_arithmetic(std::string_view name, const cs_arm& arm) {
  if (is_any_of(name, {"vdiv", "vsqrt"})) {
    return 14;
  }
  if (is_any_of(name, {"sdiv", "udiv"})) {
    return 12;
  }
  if (is_any_of(name, {"vmla", "vmls", "vnml", "vfm", "vfnm"})) {
    return 3;
  }
  if (is_any_of(name, {"dsb", "isb", "dmb"})) {
    return 1 + kRefill;
  }
  const bool moves_two = name.starts_with("vmov") && arm.op_count > 2;
  return moves_two || is_any_of(name, {"mrs", "msr", "cps"}) ? 2 : 1;
}

}  // namespace

void count_cycles(const cs_insn& decoded, Instruction& instruction) {
  const cs_arm& arm = decoded.detail->arm;
  const std::string_view name = decoded.mnemonic;
  switch (decoded.id) {
    case ARM_INS_B:
    case ARM_INS_BL:
    case ARM_INS_BX:
    case ARM_INS_CBZ:
    case ARM_INS_CBNZ:
      instruction.cycles = 1 + kRefill;
      return;
    case ARM_INS_TBB:
    case ARM_INS_TBH:
      instruction.cycles = 2 + kRefill;
      instruction.other_words = 1;
      return;
    default:
      break;
  }
  if (!count_multiple(name, arm, instruction) && !count_single(name, arm, instruction)) {
    instruction.cycles = of_arithmetic(name, arm);
  }
}

}  // namespace tactree::wcet
