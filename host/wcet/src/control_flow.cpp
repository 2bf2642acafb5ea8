#include "control_flow.hpp"

#include <fmt/core.h>

#include <algorithm>

#include "decoder.hpp"
#include "tactree/wcet/bound_error.hpp"

namespace tactree::wcet {
namespace {

/// Divides decoded instructions into basic blocks.
class BlockBuilder {
 public:
  BlockBuilder(const Image& image, const Function& function) : image_(image) {
    flow_.function = function;
    decoded_ = decode(image, function);
    for (std::uint32_t i = 0; i < decoded_.size(); ++i) {
      index_[decoded_[i].instruction.address] = i;
    }
  }

  ControlFlow build() {
    find_leaders();
    make_blocks();
    connect();
    for (DecodedInstruction& decoded : decoded_) {
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
      refuse_at(image_, from, "jumps into the middle of an instruction (rewrite the code)");
    }
    return found->second;
  }

  /// Target addresses of a jump table.
  [[nodiscard]] std::vector<std::uint32_t> table_targets(std::uint32_t at) const {
    const DecodedInstruction& d = decoded_[at];
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

  /// Number of entries of a jump table, from the comparison before it: cmp index, #last; bhi
  /// elsewhere.
  [[nodiscard]] std::uint32_t table_entries(std::uint32_t at) const {
    constexpr std::uint32_t kWindow = 8;
    const DecodedInstruction& table = decoded_[at];
    for (std::uint32_t i = at; i > 0 && at - i < kWindow; --i) {
      const DecodedInstruction& d = decoded_[i - 1];
      if (d.compared && d.compared->first == table.index_register) {
        return d.compared->second + 1;
      }
    }
    refuse_at(image_, table.instruction.address,
              "jump table of unknown length (write if statements)");
  }

  void find_leaders() {
    leaders_.insert(0);
    for (std::uint32_t i = 0; i < decoded_.size(); ++i) {
      const DecodedInstruction& d = decoded_[i];
      if (d.kind == InstructionKind::kPlain) {
        continue;
      }
      if (i + 1 < decoded_.size()) {
        leaders_.insert(i + 1);
      }
      if (d.kind == InstructionKind::kBranch && inside(d.target)) {
        leaders_.insert(index_of(d.target, d.instruction.address));
      }
      if (d.kind == InstructionKind::kTable) {
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
    const DecodedInstruction& d = decoded_[last];
    const bool falls_through =
        d.kind == InstructionKind::kPlain || d.kind == InstructionKind::kCall || d.conditional;
    if (d.kind == InstructionKind::kCall) {
      flow_.blocks[b].calls = callee(d);
    } else if (d.kind == InstructionKind::kReturn) {
      flow_.blocks[b].returns = true;
    } else if (d.kind == InstructionKind::kBranch) {
      add_edge(b, target_block(d));
    } else if (d.kind == InstructionKind::kTable) {
      for (const std::uint32_t target : table_targets(last)) {
        add_edge(b, block_of_.at(index_of(target, d.instruction.address)));
      }
    }
    // A call that never returns may be followed by data; Program finds the functions that return.
    const auto next = block_of_.find(last + 1);
    if (falls_through && next != block_of_.end()) {
      add_edge(b, next->second);
    } else if (falls_through && d.kind != InstructionKind::kCall) {
      flow_.blocks[b].runs_out = true;
    }
  }

  void add_edge(std::uint32_t from, std::uint32_t to) {
    auto& next = flow_.blocks[from].next;
    if (std::find(next.begin(), next.end(), to) == next.end()) {
      next.push_back(to);
    }
  }

  [[nodiscard]] std::uint32_t callee(const DecodedInstruction& d) const {
    if (!image_.functions().contains(d.target & ~1U)) {
      refuse_at(image_, d.instruction.address,
                fmt::format("calls {:#x}, where no function begins (build the image with symbols "
                            "of all functions)",
                            d.target));
    }
    return d.target & ~1U;
  }

  /// Block of a jump's target. A jump out of the function is a call whose return is that of this
  /// function.
  std::uint32_t target_block(const DecodedInstruction& d) {
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
  std::vector<DecodedInstruction> decoded_;
  std::map<std::uint32_t, std::uint32_t> index_;     // address -> instruction
  std::set<std::uint32_t> leaders_;                  // instructions
  std::map<std::uint32_t, std::uint32_t> block_of_;  // leader -> block
};

}  // namespace

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

ControlFlow control_flow(const Image& image, const Function& function) {
  return BlockBuilder(image, function).build();
}

std::string describe_place(const Image& image, std::uint32_t address) {
  const Function* const function = image.function_at(address);
  std::string where = function == nullptr ? fmt::format("{:#x}", address)
                                          : fmt::format("{}+{:#x}", demangled(function->name),
                                                        address - function->begin);
  const std::vector<Place> places = image.places(address);
  if (places.empty()) {
    return where;
  }
  return fmt::format("{}:{} ({})", places[0].file, places[0].line, where);
}

void refuse_at(const Image& image, std::uint32_t address, const std::string& cause) {
  throw BoundError(fmt::format("{}: {}", describe_place(image, address), cause));
}

}  // namespace tactree::wcet
