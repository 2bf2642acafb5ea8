#pragma once
// Analysis of an image that is read once, with any parameters.

#include <cstdint>
#include <optional>
#include <set>
#include <string>

#include "analysis.hpp"
#include "longest_path.hpp"

namespace tactree::wcet {

class TickAnalysis {
 public:
  /// Uses image, sources and entries of `options`. Throws BoundError.
  explicit TickAnalysis(const BoundOptions& options);

  [[nodiscard]] Bound instructions(const Parameters& parameters);
  /// Includes interrupt entry and return, and the assumption that each entry empties the code
  /// cache.
  [[nodiscard]] std::uint64_t cycles(const Parameters& parameters, const BoardTiming& timing);
  /// Formula of the cycles in the parameters of `open`.
  [[nodiscard]] CostFormula formula(const Parameters& parameters, const OpenParameters& open,
                                    const BoardTiming& timing);

 private:
  [[nodiscard]] Analysis analysis(const Parameters& parameters, const OpenParameters& open,
                                  const BoardTiming* timing);
  [[nodiscard]] double interrupt_cycles(const BoardTiming& timing) const;

  Image image_;
  SourceCode sources_;
  Entries entries_;
  std::uint32_t times_ = 0;
  std::optional<Program> program_;
  std::set<std::string> inlined_;
};

/// `parameters` with the work of this division of a tick.
[[nodiscard]] Parameters divided(Parameters parameters, std::uint32_t work_tier,
                                 const Division& division);

}  // namespace tactree::wcet
