#include "control_flow.hpp"

#include <capstone/capstone.h>
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

#include "cortex_m4_cycles.hpp"
#include "tactree/bound/bound_error.hpp"

namespace tactree::bound {
namespace {

enum class Kind { kPlain, kBranch, kCall, kReturn, kTable };

struct Decoded {
  Instruction instruction;
  Kind kind = Kind::kPlain;
  bool conditional = false;                               // it may also do nothing
  std::uint32_t target = 0;                               // of a branch or call
  int index_register = -1;                                // of a table
  unsigned table_entry = 0;                               // bytes
  std::optional<std::pair<int, std::uint32_t>> compared;  // register with a constant
};

[[noreturn]] void refuse(const Image& image, std::uint32_t address, const std::string& cause) {
  throw BoundError(fmt::format("{}: {}", describe_place(image, address), cause));
}

/// The conditions of the instructions after an IT instruction.
class ItBlock {
 public:
  /// True when the instruction at hand is in a block.
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

  std::vector<Decoded> decode(const Function& function) {
    std::vector<Decoded> result;
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
        refuse(image_, address, "unknown instruction (the analysis does not know it)");
      }
      Decoded decoded = classify(address);
      count_cycles(*instruction_, decoded.instruction);
      if (it.next(bytes.data(), instruction_->size)) {
        decoded.conditional = true;
        decoded.instruction.constant.reset();
      }
      decoded.instruction.conditional_branch = decoded.kind == Kind::kBranch && decoded.conditional;
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

  Decoded classify(std::uint32_t address) {
    Decoded d;
    d.instruction.address = address;
    d.instruction.bytes = instruction_->size;
    d.instruction.text = fmt::format("{} {}", instruction_->mnemonic, instruction_->op_str);
    switch (instruction_->id) {
      case ARM_INS_B:
        d.kind = Kind::kBranch;
        d.conditional = arm().cc != ARM_CC_AL && arm().cc != ARM_CC_INVALID;
        d.target = immediate(0).value_or(0);
        return d;
      case ARM_INS_CBZ:
      case ARM_INS_CBNZ:
        d.kind = Kind::kBranch;
        d.conditional = true;
        d.target = immediate(1).value_or(0);
        return d;
      case ARM_INS_BL:
        d.kind = Kind::kCall;
        d.target = immediate(0).value_or(0);
        return d;
      case ARM_INS_TBB:
      case ARM_INS_TBH:
        return table(d);
      case ARM_INS_BLX:
        refuse(image_, address, "indirect call (call a function by its name)");
      case ARM_INS_SVC:
      case ARM_INS_UDF:
        refuse(image_, address, "calls a handler (the analysis does not follow it)");
      default:
        return plain(d);
    }
  }

  Decoded table(Decoded& d) const {
    d.kind = Kind::kTable;
    d.table_entry = instruction_->id == ARM_INS_TBB ? 1 : 2;
    const arm_op_mem& memory = arm().operands[0].mem;
    d.index_register = static_cast<int>(memory.index) - static_cast<int>(ARM_REG_R0);
    if (memory.base != ARM_REG_PC) {
      refuse(image_, d.instruction.address, "jump table in a register (write ifs)");
    }
    return d;
  }

  Decoded plain(Decoded& d) {
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
      d.kind = Kind::kReturn;
      if (!is_return()) {
        refuse(image_, d.instruction.address, "indirect jump (call a function by its name)");
      }
      return d;
    }
    note_constants(d);
    note_words(d.instruction);
    d.instruction.store = is_store();
    return d;
  }

  /// Of the stack, or of the link register: the functions of compilers never load another there.
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

  void note_constants(Decoded& d) const {
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

  // r0 to r12 by their numbers; the others by some that none of those has.
  static int number_of(int reg) { return reg - static_cast<int>(ARM_REG_R0); }

  // A structure that goes in registers is often written to memory and read again.
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

void drop_unreachable(ControlFlow& flow) {
  std::vector<std::uint32_t> open{0};
  std::map<std::uint32_t, std::uint32_t> number{{0, 0}};
  for (std::size_t i = 0; i < open.size(); ++i) {
    for (const std::uint32_t next : flow.blocks[open[i]].next) {
      if (number.try_emplace(next, static_cast<std::uint32_t>(open.size())).second) {
        open.push_back(next);
      }
    }
  }
  std::vector<Block> kept;
  for (const std::uint32_t b : open) {
    Block block = flow.blocks[b];
    for (std::uint32_t& next : block.next) {
      next = number.at(next);
    }
    kept.push_back(std::move(block));
  }
  flow.blocks = std::move(kept);
}

/// Puts decoded instructions into blocks.
class Builder {
 public:
  Builder(const Image& image, const Function& function) : image_(image) {
    flow_.function = function;
    decoded_ = Decoder(image).decode(function);
    for (std::uint32_t i = 0; i < decoded_.size(); ++i) {
      index_[decoded_[i].instruction.address] = i;
    }
  }

  ControlFlow build() {
    find_leaders();
    make_blocks();
    connect();
    for (Decoded& decoded : decoded_) {
      flow_.instructions.push_back(std::move(decoded.instruction));
    }
    drop_unreachable(flow_);
    return std::move(flow_);
  }

 private:
  [[nodiscard]] bool inside(std::uint32_t address) const {
    return address >= flow_.function.begin && address < flow_.function.end;
  }

  [[nodiscard]] std::uint32_t index_of(std::uint32_t address, std::uint32_t from) const {
    const auto found = index_.find(address);
    if (found == index_.end()) {
      refuse(image_, from, "jumps to where no instruction begins (write it another way)");
    }
    return found->second;
  }

  /// Where a jump table leads.
  [[nodiscard]] std::vector<std::uint32_t> table_targets(std::uint32_t at) const {
    const Decoded& d = decoded_[at];
    const std::uint32_t base = d.instruction.address + 4;
    const std::uint32_t count = table_entries(at);
    const auto bytes = image_.bytes_at(base);
    std::vector<std::uint32_t> targets;
    for (std::uint32_t i = 0; i < count; ++i) {
      std::uint32_t offset = bytes[i * d.table_entry];
      if (d.table_entry == 2) {
        offset |= static_cast<std::uint32_t>(bytes[i * 2 + 1]) << 8;
      }
      targets.push_back(base + 2 * offset);
    }
    return targets;
  }

  /// The comparison before the table says how long it is: cmp index, #last; bhi elsewhere.
  [[nodiscard]] std::uint32_t table_entries(std::uint32_t at) const {
    constexpr std::uint32_t kWindow = 8;
    const Decoded& table = decoded_[at];
    for (std::uint32_t i = at; i > 0 && at - i < kWindow; --i) {
      const Decoded& d = decoded_[i - 1];
      if (d.compared && d.compared->first == table.index_register) {
        return d.compared->second + 1;
      }
    }
    refuse(image_, table.instruction.address, "jump table of unknown length (write ifs)");
  }

  void find_leaders() {
    leaders_.insert(0);
    for (std::uint32_t i = 0; i < decoded_.size(); ++i) {
      const Decoded& d = decoded_[i];
      if (d.kind == Kind::kPlain) {
        continue;
      }
      if (i + 1 < decoded_.size()) {
        leaders_.insert(i + 1);
      }
      if (d.kind == Kind::kBranch && inside(d.target)) {
        leaders_.insert(index_of(d.target, d.instruction.address));
      }
      if (d.kind == Kind::kTable) {
        for (const std::uint32_t target : table_targets(i)) {
          leaders_.insert(index_of(target, d.instruction.address));
        }
      }
    }
  }

  void make_blocks() {
    for (auto leader = leaders_.begin(); leader != leaders_.end(); ++leader) {
      const auto after = std::next(leader);
      const auto end =
          after == leaders_.end() ? static_cast<std::uint32_t>(decoded_.size()) : *after;
      block_of_[*leader] = static_cast<std::uint32_t>(flow_.blocks.size());
      Block block;
      block.first = *leader;
      block.count = end - *leader;
      flow_.blocks.push_back(block);
    }
  }

  void connect() {
    const auto count = static_cast<std::uint32_t>(flow_.blocks.size());
    for (std::uint32_t b = 0; b < count; ++b) {
      connect(b);
    }
  }

  void connect(std::uint32_t b) {
    const std::uint32_t last = flow_.blocks[b].first + flow_.blocks[b].count - 1;
    const Decoded& d = decoded_[last];
    const bool falls_through = d.kind == Kind::kPlain || d.kind == Kind::kCall || d.conditional;
    if (d.kind == Kind::kCall) {
      flow_.blocks[b].calls = callee(d);
    } else if (d.kind == Kind::kReturn) {
      flow_.blocks[b].returns = true;
    } else if (d.kind == Kind::kBranch) {
      add_edge(b, target_block(d));
    } else if (d.kind == Kind::kTable) {
      for (const std::uint32_t target : table_targets(last)) {
        add_edge(b, block_of_.at(index_of(target, d.instruction.address)));
      }
    }
    // After a call that never returns there may be data; the analysis finds out who returns.
    const auto next = block_of_.find(last + 1);
    if (falls_through && next != block_of_.end()) {
      add_edge(b, next->second);
    } else if (falls_through && d.kind != Kind::kCall) {
      flow_.blocks[b].runs_out = true;
    }
  }

  void add_edge(std::uint32_t from, std::uint32_t to) {
    auto& next = flow_.blocks[from].next;
    if (std::find(next.begin(), next.end(), to) == next.end()) {
      next.push_back(to);
    }
  }

  [[nodiscard]] std::uint32_t callee(const Decoded& d) const {
    if (!image_.functions().contains(d.target & ~1U)) {
      refuse(image_, d.instruction.address,
             fmt::format("calls {:#x}, where no function begins (correct it)", d.target));
    }
    return d.target & ~1U;
  }

  /// A jump out of the function is a call whose return is ours.
  std::uint32_t target_block(const Decoded& d) {
    if (inside(d.target)) {
      return block_of_.at(index_of(d.target, d.instruction.address));
    }
    Block jump;
    jump.first = index_.at(d.instruction.address);
    jump.calls = callee(d);
    jump.returns = true;
    flow_.blocks.push_back(jump);
    return static_cast<std::uint32_t>(flow_.blocks.size() - 1);
  }

  const Image& image_;
  ControlFlow flow_;
  std::vector<Decoded> decoded_;
  std::map<std::uint32_t, std::uint32_t> index_;     // address -> instruction
  std::set<std::uint32_t> leaders_;                  // instructions
  std::map<std::uint32_t, std::uint32_t> block_of_;  // leader -> block
};

/// Finds the natural loops of a graph whose blocks are all reachable from block 0.
class LoopFinder {
 public:
  LoopFinder(const Image& image, ControlFlow& flow)
      : image_(image), flow_(flow), before_(flow.blocks.size()) {
    for (std::uint32_t b = 0; b < flow_.blocks.size(); ++b) {
      for (const std::uint32_t next : flow_.blocks[b].next) {
        before_[next].push_back(b);
      }
    }
  }

  void find() {
    find_dominators();
    std::map<std::uint32_t, Loop> by_header;
    std::vector<Edge> irregular;
    for (const Edge& edge : retreating_edges()) {
      if (!dominators_[edge.first].contains(edge.second)) {
        irregular.push_back(edge);
        continue;
      }
      Loop& loop = by_header[edge.second];
      loop.header = edge.second;
      loop.back.push_back(edge);
      collect(loop, edge.first);
    }
    for (auto& [header, loop] : by_header) {
      flow_.loops.push_back(std::move(loop));
    }
    for (const Edge& edge : irregular) {
      add_irregular(edge);
    }
    nest();
  }

 private:
  void find_dominators() {
    std::set<std::uint32_t> all;
    for (std::uint32_t b = 0; b < flow_.blocks.size(); ++b) {
      all.insert(b);
    }
    dominators_.assign(flow_.blocks.size(), all);
    dominators_[0] = {0};
    for (bool changed = true; changed;) {
      changed = false;
      for (std::uint32_t b = 1; b < flow_.blocks.size(); ++b) {
        std::set<std::uint32_t> common = dominators_[before_[b][0]];
        for (const std::uint32_t p : before_[b]) {
          std::erase_if(common, [&](std::uint32_t d) { return !dominators_[p].contains(d); });
        }
        common.insert(b);
        changed = changed || common != dominators_[b];
        dominators_[b] = std::move(common);
      }
    }
  }

  /// Edges to a block that the search is still below.
  std::vector<Edge> retreating_edges() {
    std::vector<Edge> result;
    std::vector<int> state(flow_.blocks.size(), 0);  // 1: on the way here, 2: done
    std::vector<std::pair<std::uint32_t, std::size_t>> way{{0, 0}};
    state[0] = 1;
    while (!way.empty()) {
      const std::uint32_t block = way.back().first;
      const auto& next = flow_.blocks[block].next;
      if (way.back().second == next.size()) {
        state[block] = 2;
        way.pop_back();
        continue;
      }
      const std::uint32_t to = next[way.back().second++];
      if (state[to] == 1) {
        result.emplace_back(block, to);
      } else if (state[to] == 0) {
        state[to] = 1;
        way.emplace_back(to, 0);
      }
    }
    return result;
  }

  void collect(Loop& loop, std::uint32_t from) const {
    loop.blocks.insert(loop.header);
    std::vector<std::uint32_t> open{from};
    while (!open.empty()) {
      const std::uint32_t block = open.back();
      open.pop_back();
      if (loop.blocks.insert(block).second) {
        open.insert(open.end(), before_[block].begin(), before_[block].end());
      }
    }
  }

  /// A loop that is entered in several places. It needs a block that is on every way around.
  void add_irregular(const Edge& edge) {
    for (const Loop& known : flow_.loops) {
      if (known.irregular && known.blocks.contains(edge.first)) {
        return;
      }
    }
    Loop loop;
    loop.irregular = true;
    loop.blocks = round_trip(edge.first, room_of(edge));
    std::erase_if(flow_.loops,
                  [&](const Loop& inner) { return includes(loop.blocks, inner.blocks); });
    for (const std::uint32_t b : loop.blocks) {
      if (is_on_every_round(b, loop.blocks)) {
        loop.header = b;
        for (const std::uint32_t from : before_[b]) {
          if (loop.blocks.contains(from)) {
            loop.back.emplace_back(from, b);
          }
        }
        flow_.loops.push_back(std::move(loop));
        return;
      }
    }
    refuse(image_, flow_.instructions[flow_.blocks[edge.second].first].address,
           "loops that are entered in several places (write them as one loop each)");
  }

  static bool includes(const std::set<std::uint32_t>& all, const std::set<std::uint32_t>& some) {
    return std::includes(all.begin(), all.end(), some.begin(), some.end());
  }

  /// The blocks that a loop through this edge may consist of: those of the smallest loop around,
  /// without its header.
  [[nodiscard]] std::set<std::uint32_t> room_of(const Edge& edge) const {
    std::set<std::uint32_t> room;
    for (std::uint32_t b = 0; b < flow_.blocks.size(); ++b) {
      room.insert(b);
    }
    for (const Loop& loop : flow_.loops) {
      std::set<std::uint32_t> inner = loop.blocks;
      inner.erase(loop.header);
      if (inner.contains(edge.first) && inner.contains(edge.second) && inner.size() < room.size()) {
        room = std::move(inner);
      }
    }
    return room;
  }

  /// The blocks of `room` that lead to `block` and that it leads to.
  [[nodiscard]] std::set<std::uint32_t> round_trip(std::uint32_t block,
                                                   const std::set<std::uint32_t>& room) const {
    const auto reached = [&](const auto& next_of) {
      std::set<std::uint32_t> seen{block};
      std::vector<std::uint32_t> open{block};
      while (!open.empty()) {
        const std::uint32_t here = open.back();
        open.pop_back();
        for (const std::uint32_t next : next_of(here)) {
          if (room.contains(next) && seen.insert(next).second) {
            open.push_back(next);
          }
        }
      }
      return seen;
    };
    std::set<std::uint32_t> both = reached([&](std::uint32_t b) { return flow_.blocks[b].next; });
    const std::set<std::uint32_t> to = reached([&](std::uint32_t b) { return before_[b]; });
    std::erase_if(both, [&](std::uint32_t b) { return !to.contains(b); });
    return both;
  }

  [[nodiscard]] bool is_on_every_round(std::uint32_t block,
                                       const std::set<std::uint32_t>& blocks) const {
    std::set<std::uint32_t> left = blocks;
    left.erase(block);
    // Takes away, again and again, the blocks that nothing which is left leads to.
    for (bool changed = true; changed;) {
      const std::size_t count = left.size();
      std::erase_if(left, [&](std::uint32_t b) {
        return std::none_of(before_[b].begin(), before_[b].end(),
                            [&](std::uint32_t from) { return left.contains(from); });
      });
      changed = left.size() != count;
    }
    return left.empty();
  }

  void nest() {
    auto& loops = flow_.loops;
    std::sort(loops.begin(), loops.end(), [](const Loop& a, const Loop& b) {
      return std::pair(b.blocks.size(), a.header) < std::pair(a.blocks.size(), b.header);
    });
    for (std::uint32_t i = 0; i < loops.size(); ++i) {
      for (std::uint32_t outer = 0; outer < i; ++outer) {
        if (loops[outer].blocks.contains(loops[i].header)) {
          loops[i].parent = outer;  // the last is the smallest
        }
      }
      for (const std::uint32_t b : loops[i].blocks) {
        for (const std::uint32_t from : before_[b]) {
          if (!loops[i].blocks.contains(from)) {
            loops[i].entries.emplace_back(from, b);
          }
        }
      }
    }
  }

  const Image& image_;
  ControlFlow& flow_;
  std::vector<std::vector<std::uint32_t>> before_;
  std::vector<std::set<std::uint32_t>> dominators_;
};

}  // namespace

std::vector<Edge> ControlFlow::entries_of(std::uint32_t block) const {
  std::vector<Edge> result;
  for (std::uint32_t b = 0; b < blocks.size(); ++b) {
    for (const std::uint32_t next : blocks[b].next) {
      if (next == block) {
        result.emplace_back(b, block);
      }
    }
  }
  return result;
}

namespace {

/// Follows the content of a register backwards, to the constant that was put there.
class Origin {
 public:
  explicit Origin(int number) : number_(number) {}

  [[nodiscard]] bool lost() const { return lost_; }
  /// The register it is in by now; nothing: it is in memory.
  [[nodiscard]] std::optional<int> where() const {
    return in_memory_ ? std::nullopt : std::optional(number_);
  }
  [[nodiscard]] std::optional<std::uint32_t> constant() const { return constant_; }

  void pass(const Instruction& instruction) {
    if (in_memory_) {
      pass_memory(instruction);
    } else if (instruction.constant && instruction.constant->first == number_) {
      constant_ = instruction.constant->second;
    } else if (instruction.written.contains(number_)) {
      load(instruction);
    }
  }

 private:
  void load(const Instruction& instruction) {
    lost_ = !instruction.loaded.has_value();
    if (lost_) {
      return;
    }
    const auto& registers = instruction.loaded->registers;
    const auto at = std::find(registers.begin(), registers.end(), number_) - registers.begin();
    in_memory_ = true;
    base_ = instruction.loaded->base;
    offset_ = instruction.loaded->offset + 4 * static_cast<std::int32_t>(at);
  }

  void pass_memory(const Instruction& instruction) {
    if (instruction.stored && instruction.stored->base == base_) {
      const std::int32_t word = (offset_ - instruction.stored->offset) / 4;
      if (word == 0 || word == 1) {
        number_ = instruction.stored->registers[static_cast<std::size_t>(word)];
        in_memory_ = false;
        return;
      }
    }
    lost_ = instruction.writes_memory || instruction.written.contains(base_);
  }

  int number_;
  bool in_memory_ = false;
  int base_ = 0;
  std::int32_t offset_ = 0;
  bool lost_ = false;
  std::optional<std::uint32_t> constant_;
};

}  // namespace

Argument ControlFlow::argument(std::uint32_t block, int number) const {
  Origin origin(number);
  // Back along the only way here.
  for (std::size_t steps = 0; steps < blocks.size(); ++steps) {
    const Block& here = blocks[block];
    for (std::uint32_t i = here.count; i > 0; --i) {
      origin.pass(instructions[here.first + i - 1]);
      if (origin.constant() || origin.lost()) {
        return {origin.constant(), {}};
      }
    }
    const std::vector<Edge> entries = entries_of(block);
    if (block == 0 && entries.empty()) {
      return {{}, origin.where()};
    }
    if (entries.size() != 1 || blocks[entries[0].first].calls) {
      return {};
    }
    block = entries[0].first;
  }
  return {};
}

ControlFlow control_flow(const Image& image, const Function& function) {
  return Builder(image, function).build();
}

void find_loops(const Image& image, ControlFlow& flow,
                const std::set<std::uint32_t>& never_return) {
  for (Block& block : flow.blocks) {
    if (block.calls && never_return.contains(*block.calls)) {
      block.next.clear();
      block.returns = false;
    }
  }
  drop_unreachable(flow);
  for (const Block& block : flow.blocks) {
    if (block.runs_out) {
      refuse(image, flow.instructions[block.first].address,
             "runs past the end of its function (correct it)");
    }
  }
  LoopFinder(image, flow).find();
}

std::string describe_place(const Image& image, std::uint32_t address) {
  const Function* const function = image.function_at(address);
  const std::string where = function == nullptr ? fmt::format("{:#x}", address)
                                                : fmt::format("{}+{:#x}", demangled(function->name),
                                                              address - function->begin);
  const std::vector<Place> places = image.places(address);
  if (places.empty()) {
    return where;
  }
  return fmt::format("{}:{} ({})", places[0].file, places[0].line, where);
}

}  // namespace tactree::bound
