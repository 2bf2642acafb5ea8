#pragma once
// Control flow graph of a function's machine code: basic blocks, edges and loops.

#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "image.hpp"

namespace tactree::wcet {

struct Instruction {
  std::uint32_t address = 0;
  std::uint32_t bytes = 0;
  std::string text;    ///< mnemonic and operands
  bool store = false;  ///< to memory, not relative to the stack pointer
  bool conditional_branch = false;
  std::uint32_t cycles = 0;       ///< maximum for a Cortex-M4, without memory wait states
  std::uint32_t stack_words = 0;  ///< loaded or stored relative to the stack pointer
  std::uint32_t other_words = 0;  ///< loaded or stored elsewhere
  bool literal = false;           ///< other_words are in the literal pool of the code
  /// A constant moved to a register.
  std::optional<std::pair<int, std::uint32_t>> constant;
  std::set<int> written;  ///< core registers
  /// Words in memory from `base` + `offset`, and the registers they are loaded to or stored from.
  struct Words {
    int base = 0;
    std::int32_t offset = 0;
    std::vector<int> registers;
  };
  std::optional<Words> stored;
  std::optional<Words> loaded;
  bool writes_memory = false;
};

/// A basic block. A call ends a block; the callee executes between this block and the next.
struct Block {
  std::uint32_t first = 0;  ///< index of its first instruction
  std::uint32_t count = 0;  ///< 0 for a jump to another function, which is a separate block
  std::vector<std::uint32_t> next;
  bool returns = false;
  bool runs_out = false;               ///< continues past the end of the function
  std::optional<std::uint32_t> calls;  ///< entry of a function
};

using Edge = std::pair<std::uint32_t, std::uint32_t>;

/// A natural loop: all blocks that reach its back edges without passing its header. An irregular
/// loop has several entries, and its header is a block on every path around the loop; compilers
/// generate it when they know the path of the first pass.
struct NaturalLoop {
  std::uint32_t header = 0;
  bool irregular = false;
  std::set<std::uint32_t> blocks;
  std::vector<Edge> back;
  std::vector<Edge> entries;
  std::optional<std::uint32_t> parent;  ///< the smallest enclosing loop
};

/// Content of an argument register at a call: a constant, or an argument register that the caller
/// passes on. Unknown if both are empty.
struct Argument {
  std::optional<std::uint32_t> constant;
  std::optional<int> passed_on;
};

/// Control flow graph of one function. Block 0 is the entry.
struct ControlFlow {
  Function function;
  std::vector<Instruction> instructions;
  std::vector<Block> blocks;
  std::vector<NaturalLoop> loops;  ///< an outer loop precedes its inner loops

  [[nodiscard]] std::vector<Edge> entries_of(std::uint32_t block) const;
  /// Content of r<number> when the call of this block begins.
  [[nodiscard]] Argument argument(std::uint32_t block, int number) const;
};

/// Blocks and edges, without loops. Throws BoundError with file and line on an unknown instruction
/// and on an indirect call or jump.
[[nodiscard]] ControlFlow control_flow(const Image& image, const Function& function);

/// Removes blocks that are not reachable from block 0.
void drop_unreachable(ControlFlow& flow);

/// Removes the code after calls of functions that never return, then finds the loops. Throws
/// BoundError on an irregular loop without a block on every path around it.
void find_loops(const Image& image, ControlFlow& flow, const std::set<std::uint32_t>& never_return);

/// "file:line (function+offset)" of an instruction, for messages.
[[nodiscard]] std::string describe_place(const Image& image, std::uint32_t address);

/// Throws BoundError with the location of the instruction.
[[noreturn]] void refuse_at(const Image& image, std::uint32_t address, const std::string& cause);

}  // namespace tactree::wcet
