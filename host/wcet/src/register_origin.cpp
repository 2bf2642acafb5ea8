// Content of an argument register when a call begins.
#include <algorithm>

#include "control_flow.hpp"

namespace tactree::wcet {
namespace {

/// Follows the content of a register backwards to the constant it was loaded with.
class Origin {
 public:
  explicit Origin(int number) : number_(number) {}

  [[nodiscard]] bool lost() const { return lost_; }
  /// Register that holds the content; nullopt if it is in memory.
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
  // Goes backwards as long as there is exactly one predecessor.
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

}  // namespace tactree::wcet
