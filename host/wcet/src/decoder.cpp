#include "decoder.hpp"

#include <capstone/capstone.h>
#include <fmt/core.h>

#include <algorithm>
#include <bit>
#include <string_view>

#include "cortex_m4_cycles.hpp"
#include "tactree/wcet/bound_error.hpp"

namespace tactree::wcet {
namespace {

/// Counts the conditional instructions after an IT instruction.
class ItBlock {
 public:
  /// Call it for each instruction in order. Returns true if the instruction is in an IT block.
  bool next(const std::uint8_t* code, std::size_t bytes) {
    if (left_ > 0) {
      --left_;
      return true;
    }
    const unsigned half = bytes == 2 ? code[0] | static_cast<unsigned>(code[1]) << 8 : 0U;
    if ((half & 0xFF00U) == 0xBF00U && (half & 0xFU) != 0U) {
      left_ = 4U - static_cast<unsigned>(std::countr_zero(half & 0xFU));
    }
    return false;
  }

 private:
  unsigned left_ = 0;
};

class Decoder {
 public:
  explicit Decoder(const Image& image) : image_(image) {
    const auto mode = static_cast<cs_mode>(CS_MODE_THUMB | CS_MODE_MCLASS | CS_MODE_V8);
    if (cs_open(CS_ARCH_ARM, mode, &handle_) != CS_ERR_OK) {
      throw BoundError("the disassembler does not start (install libcapstone)");
    }
    cs_option(handle_, CS_OPT_DETAIL, CS_OPT_ON);
    instruction_ = cs_malloc(handle_);
  }
  ~Decoder() {
    cs_free(instruction_, 1);
    cs_close(&handle_);
  }
  Decoder(const Decoder&) = delete;
  Decoder& operator=(const Decoder&) = delete;

  std::vector<DecodedInstruction> decode(const Function& function) {
    std::vector<DecodedInstruction> result;
    ItBlock it;
    std::uint32_t address = function.begin;
    while (address < function.end) {
      if (!image_.is_code(address)) {
        address += 2;
        continue;
      }
      const auto bytes = image_.bytes_at(address);
      const std::uint8_t* code = bytes.data();
      std::size_t size = std::min<std::size_t>(bytes.size(), function.end - address);
      std::uint64_t at = address;
      if (!cs_disasm_iter(handle_, &code, &size, &at, instruction_)) {
        refuse_at(
            image_, address,
            "unknown instruction (the decoder knows those of Cortex-M4, M7 and M33: compile for "
            "one of them, or add it)");
      }
      DecodedInstruction decoded = classify(address);
      count_cycles(*instruction_, decoded.instruction);
      if (it.next(bytes.data(), instruction_->size)) {
        decoded.conditional = true;
        decoded.instruction.constant.reset();
      }
      decoded.instruction.conditional_branch =
          decoded.kind == InstructionKind::kBranch && decoded.conditional;
      result.push_back(std::move(decoded));
      address += instruction_->size;
    }
    return result;
  }

 private:
  [[nodiscard]] const cs_arm& arm() const { return instruction_->detail->arm; }
  [[nodiscard]] bool is(unsigned index, arm_reg reg) const {
    return index < arm().op_count && arm().operands[index].type == ARM_OP_REG &&
           arm().operands[index].reg == static_cast<int>(reg);
  }
  [[nodiscard]] std::optional<std::uint32_t> immediate(unsigned index) const {
    if (index >= arm().op_count || arm().operands[index].type != ARM_OP_IMM) {
      return std::nullopt;
    }
    return static_cast<std::uint32_t>(arm().operands[index].imm);
  }
  [[nodiscard]] int low_register(unsigned index) const {
    if (index >= arm().op_count || arm().operands[index].type != ARM_OP_REG) {
      return -1;
    }
    const int number = static_cast<int>(arm().operands[index].reg) - static_cast<int>(ARM_REG_R0);
    return number >= 0 && number <= 12 ? number : -1;
  }

  DecodedInstruction classify(std::uint32_t address) {
    DecodedInstruction d;
    d.instruction.address = address;
    d.instruction.bytes = instruction_->size;
    d.instruction.text = fmt::format("{} {}", instruction_->mnemonic, instruction_->op_str);
    switch (instruction_->id) {
      case ARM_INS_B:
        d.kind = InstructionKind::kBranch;
        d.conditional = arm().cc != ARM_CC_AL && arm().cc != ARM_CC_INVALID;
        d.target = immediate(0).value_or(0);
        return d;
      case ARM_INS_CBZ:
      case ARM_INS_CBNZ:
        d.kind = InstructionKind::kBranch;
        d.conditional = true;
        d.target = immediate(1).value_or(0);
        return d;
      case ARM_INS_BL:
        d.kind = InstructionKind::kCall;
        d.target = immediate(0).value_or(0);
        return d;
      case ARM_INS_TBB:
      case ARM_INS_TBH:
        return table(d);
      case ARM_INS_BLX:
        refuse_at(image_, address, "indirect call (call a function by its name)");
      case ARM_INS_SVC:
      case ARM_INS_UDF:
        refuse_at(image_, address, "calls an exception handler (the analysis cannot follow it)");
      default:
        return plain(d);
    }
  }

  DecodedInstruction table(DecodedInstruction& d) const {
    d.kind = InstructionKind::kTable;
    d.table_entry = instruction_->id == ARM_INS_TBB ? 1 : 2;
    const arm_op_mem& memory = arm().operands[0].mem;
    d.index_register = static_cast<int>(memory.index) - static_cast<int>(ARM_REG_R0);
    if (memory.base != ARM_REG_PC) {
      refuse_at(image_, d.instruction.address, "jump table in a register (write if statements)");
    }
    return d;
  }

  DecodedInstruction plain(DecodedInstruction& d) {
    cs_regs read;
    cs_regs written;
    std::uint8_t reads = 0;
    std::uint8_t writes = 0;
    cs_regs_access(handle_, instruction_, read, &reads, written, &writes);
    bool writes_pc = instruction_->id == ARM_INS_BX || instruction_->id == ARM_INS_BXJ;
    for (unsigned i = 0; i < writes; ++i) {
      writes_pc = writes_pc || written[i] == ARM_REG_PC;
      const int number = static_cast<int>(written[i]) - static_cast<int>(ARM_REG_R0);
      d.instruction.written.insert(number);
    }
    if (writes_pc) {
      d.kind = InstructionKind::kReturn;
      if (!is_return()) {
        refuse_at(image_, d.instruction.address, "indirect jump (call a function by its name)");
      }
      return d;
    }
    note_constants(d);
    note_words(d.instruction);
    d.instruction.store = is_store();
    return d;
  }

  /// True if the program counter is loaded from the stack or the link register. Compilers load
  /// nothing but return addresses in this way.
  [[nodiscard]] bool is_return() const {
    switch (instruction_->id) {
      case ARM_INS_POP:
        return true;
      case ARM_INS_BX:
        return is(0, ARM_REG_LR);
      case ARM_INS_MOV:
        return is(1, ARM_REG_LR);
      case ARM_INS_LDM:
        return is(0, ARM_REG_SP);
      case ARM_INS_LDR:
        return arm().operands[1].type == ARM_OP_MEM && arm().operands[1].mem.base == ARM_REG_SP &&
               arm().writeback;
      default:
        return false;
    }
  }

  void note_constants(DecodedInstruction& d) const {
    const int number = low_register(0);
    const auto value = immediate(1);
    const bool moves = instruction_->id == ARM_INS_MOV || instruction_->id == ARM_INS_MOVW;
    if (value && moves && arm().op_count == 2) {
      d.instruction.constant = {number_of(arm().operands[0].reg), *value};
    }
    if (instruction_->id == ARM_INS_CMP && number >= 0 && value) {
      d.compared = {number, *value};
    }
  }

  // 0 to 12 for r0 to r12; other numbers for other registers.
  static int number_of(int reg) { return reg - static_cast<int>(ARM_REG_R0); }

  // Needed because compilers often store a structure that was passed in registers and load it
  // again.
  void note_words(Instruction& instruction) const {
    const std::string_view name = instruction_->mnemonic;
    instruction.writes_memory = name.starts_with("st") || name.starts_with("vst") ||
                                name.starts_with("push") || name.starts_with("vpush");
    if (instruction_->id == ARM_INS_STRD && arm().op_count == 3 && !arm().writeback) {
      instruction.stored = {number_of(static_cast<int>(arm().operands[2].mem.base)),
                            arm().operands[2].mem.disp,
                            {number_of(arm().operands[0].reg), number_of(arm().operands[1].reg)}};
    } else if (instruction_->id == ARM_INS_LDM && !arm().writeback) {
      instruction.loaded = {number_of(arm().operands[0].reg), 0, {}};
      for (unsigned i = 1; i < arm().op_count; ++i) {
        instruction.loaded->registers.push_back(number_of(arm().operands[i].reg));
      }
    }
  }

  [[nodiscard]] bool is_store() const {
    const std::string_view name = instruction_->mnemonic;
    if (!name.starts_with("str") && !name.starts_with("vstr") && !name.starts_with("stm") &&
        !name.starts_with("vstm")) {
      return false;
    }
    for (unsigned i = 0; i < arm().op_count; ++i) {
      if (arm().operands[i].type == ARM_OP_MEM) {
        return arm().operands[i].mem.base != ARM_REG_SP;
      }
    }
    return !is(0, ARM_REG_SP);
  }

  const Image& image_;
  csh handle_ = 0;
  cs_insn* instruction_ = nullptr;
};

}  // namespace

std::vector<DecodedInstruction> decode(const Image& image, const Function& function) {
  return Decoder(image).decode(function);
}

}  // namespace tactree::wcet
