#pragma once
// The maximum cost of an execution that control flow and annotations allow, as the maximum of a
// linear program; or an upper bound of it as a formula in the open parameters.

#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "analysis.hpp"

namespace tactree::wcet {

/// Tolerance for the rounding errors of a simplex solution.
inline constexpr double kRounding = 1e-3;

struct WorstPath {
  double cost = 0.0;  ///< cycles or instructions, see Analysis::timing
  std::map<std::uint32_t, FunctionOnPath> functions;
  std::vector<LoopOnPath> loops;
  std::map<std::uint32_t, BlockOnPath> blocks;
  std::set<const SourceFact*> used_facts;
};

/// base + the sum over the open parameters of per[name] * (value - minimum).
struct CostFormula {
  double base = 0.0;
  std::map<std::string, double> per;
};

/// Throws BoundError, also if an annotation names an open parameter in a function whose bounds name
/// arguments.
[[nodiscard]] WorstPath longest_path(const Analysis& analysis, const Entries& entries,
                                     const Parameters& arguments);

/// Not less than the cost of longest_path() for any values in the ranges of the open parameters;
/// tight near the values that Analysis::parameters has for them. Throws BoundError.
[[nodiscard]] CostFormula cost_formula(const Analysis& analysis, const Entries& entries);

}  // namespace tactree::wcet
