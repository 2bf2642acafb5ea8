#pragma once
// Cost of a block of machine code: instructions, or cycles with the wait states of the memories.
//
// Fetch model (BoardTiming): a block fetches each of its code lines from flash; the next line is
// prefetched while the current one executes, unless an instruction accesses the flash itself. A
// loop that fits into the code cache together with all its callees fetches each line once per
// entry. Code in RAM is fetched without waits.

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <vector>

#include "analysis.hpp"

namespace tactree::wcet {

/// Loops of one function that the code cache holds; of nested loops, the outermost one.
struct CachedLoops {
  std::vector<std::optional<std::uint32_t>> loop_of;  ///< by block
  std::map<std::uint32_t, double> fetch;  ///< by loop: cycles to fetch its lines, once per entry
};

class BlockCosts {
 public:
  /// `analysis` must outlive the object.
  explicit BlockCosts(const Analysis& analysis) : analysis_(analysis) {}

  [[nodiscard]] CachedLoops cached_loops(const ControlFlow& flow) const;
  /// Cost of one pass of block `b` after a jump to it, without its callees.
  [[nodiscard]] double pass(const ControlFlow& flow, const CachedLoops& cached,
                            std::uint32_t b) const;
  /// Cycles to load the cached loop that the edge enters; 0 if it enters none. `from` is nullopt
  /// for the function's entry.
  static double load(const CachedLoops& cached, std::optional<std::uint32_t> from,
                     std::uint32_t to);
  /// Cycles that pass() overestimates when block `from` runs into `to` without a jump, because the
  /// first line of `to` has been fetched or prefetched already.
  [[nodiscard]] double saved_by_falling(const ControlFlow& flow, const CachedLoops& cached,
                                        std::uint32_t from, std::uint32_t to) const;
  /// Cycles that pass() overestimates when the conditional branch at the end of `from` is not
  /// taken, because the pipeline stays filled.
  [[nodiscard]] double saved_by_staying(const ControlFlow& flow, std::uint32_t from,
                                        std::uint32_t to) const;

 private:
  using CodeLines = std::set<std::uint32_t>;  // addresses in units of line_bytes

  void add_lines(const ControlFlow& flow, const Block& block, CodeLines& lines) const;
  void add_targets(const ControlFlow& flow, const NaturalLoop& loop, const Block& block,
                   CodeLines& lines) const;
  void add_callee(std::uint32_t entry, CodeLines& lines) const;
  [[nodiscard]] bool runs_from_ram(const Instruction& instruction) const;
  [[nodiscard]] std::uint32_t slow_words(const Instruction& instruction) const;
  [[nodiscard]] double execution(const ControlFlow& flow, const Block& block) const;
  [[nodiscard]] double fetch(const ControlFlow& flow, const Block& block) const;
  [[nodiscard]] double prefetched_after(const Instruction& instruction, double cycles) const;
  [[nodiscard]] double prefetched_by(const ControlFlow& flow, const Block& block,
                                     std::uint32_t line) const;

  const Analysis& analysis_;
};

}  // namespace tactree::wcet
