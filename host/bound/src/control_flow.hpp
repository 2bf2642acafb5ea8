#pragma once
// The blocks of a function's machine code, the ways between them, and its loops.

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "image.hpp"

namespace tactree::bound {

struct Instruction {
  std::uint32_t address = 0;
  std::uint32_t bytes = 0;
  std::string text;    ///< mnemonic and operands
  bool store = false;  ///< to memory, but not relative to the stack pointer
  bool conditional_branch = false;
  std::uint32_t cycles = 0;       ///< of a Cortex-M4 at most, where no memory makes it wait
  std::uint32_t stack_words = 0;  ///< it loads or stores relative to the stack pointer
  std::uint32_t other_words = 0;  ///< and anywhere else
  bool literal = false;           ///< these lie beside the code
  /// A constant put into a register.
  std::optional<std::pair<int, std::uint32_t>> constant;
  std::set<int> written;  ///< of the core's registers
  /// Words in memory from `base` + `offset` on, and the registers they come from or go to.
  struct Words {
    int base = 0;
    std::int32_t offset = 0;
    std::vector<int> registers;
  };
  std::optional<Words> stored;
  std::optional<Words> loaded;
  bool writes_memory = false;
};

/// Instructions that are executed one after the other. A call ends a block; what it calls is
/// executed between this block and the next.
struct Block {
  std::uint32_t first = 0;  ///< index of its first instruction
  std::uint32_t count = 0;  ///< 0: a jump to another function, as a block of its own
  std::vector<std::uint32_t> next;
  bool returns = false;
  bool runs_out = false;  ///< past the end of its function; of blocks that nothing leads to
  std::optional<std::uint32_t> calls;  ///< entry of a function
};

using Edge = std::pair<std::uint32_t, std::uint32_t>;

/// A natural loop: all that can reach its back edges without passing its header. Or an irregular
/// one, which compilers make when they know the way through the first pass: it is entered anywhere,
/// and its header is a block that is on every way around.
struct Loop {
  std::uint32_t header = 0;
  bool irregular = false;
  std::set<std::uint32_t> blocks;
  std::vector<Edge> back;
  std::vector<Edge> entries;
  std::optional<std::uint32_t> parent;  ///< the smallest loop around it
};

/// What is in a register when a function is called: a constant, or what the caller itself was given
/// in a register, or something else.
struct Argument {
  std::optional<std::uint32_t> constant;
  std::optional<int> passed_on;
};

/// Of one function. Block 0 is the entry.
struct ControlFlow {
  Function function;
  std::vector<Instruction> instructions;
  std::vector<Block> blocks;
  std::vector<Loop> loops;  ///< a loop comes before those within it

  [[nodiscard]] std::vector<Edge> entries_of(std::uint32_t block) const;
  /// What r<number> holds when the block's call begins.
  [[nodiscard]] Argument argument(std::uint32_t block, int number) const;
};

/// Blocks and edges, without the loops. Throws BoundError, naming file and line, on what it cannot
/// follow: an unknown instruction, an indirect call or jump.
[[nodiscard]] ControlFlow control_flow(const Image& image, const Function& function);

/// Takes away what follows calls of functions that never return, then finds the loops. Throws
/// BoundError on loops that cannot be told apart.
void find_loops(const Image& image, ControlFlow& flow, const std::set<std::uint32_t>& never_return);

/// "file:line (function+offset)" of an instruction, for messages.
[[nodiscard]] std::string describe_place(const Image& image, std::uint32_t address);

}  // namespace tactree::bound
