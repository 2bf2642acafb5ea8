#pragma once
// The control flow of a program as a linear program. The passes of each edge between blocks are a
// variable, and the flow into a block equals the flow out of it.

#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "analysis.hpp"
#include "block_costs.hpp"
#include "linear_program.hpp"
#include "longest_path.hpp"

namespace tactree::wcet {

struct FunctionVariables {
  int entry = 0;  ///< calls of the function
  std::map<Edge, int> edges;
};

class FlowConstraints {
 public:
  /// All arguments must outlive the object. Variables and rows are added to `program`.
  FlowConstraints(const Analysis& analysis, const NameValues& values, LinearProgram& program)
      : analysis_(analysis), values_(values), costs_(analysis), program_(program) {}

  /// Adds the functions that the entries reach, except those whose bounds name their arguments:
  /// each call of such a function is solved separately and is a cost of its block.
  void add(const Entries& entries);

  [[nodiscard]] const std::map<std::uint32_t, FunctionVariables>& variables() const {
    return variables_;
  }
  [[nodiscard]] const AnalysedFunction& function(std::uint32_t entry) const {
    return analysis_.program.at(entry);
  }
  /// Passes of a block.
  [[nodiscard]] Terms passes(std::uint32_t entry, std::uint32_t b) const;
  /// Passes of these edges.
  [[nodiscard]] Terms edges(std::uint32_t entry, const std::vector<Edge>& wanted) const;
  /// Entries of a loop; each call of the function is one if its first block is in the loop.
  [[nodiscard]] Terms entered(std::uint32_t entry, const NaturalLoop& loop) const;
  /// The worst case of the call that ends a block, by {function, block}: those solved by
  /// themselves.
  [[nodiscard]] const std::map<std::pair<std::uint32_t, std::uint32_t>, WorstPath>& calls() const {
    return calls_;
  }

 private:
  [[nodiscard]] bool calls_one_that_returns(const Block& block) const;
  [[nodiscard]] bool shares_callee(const Block& block) const;
  void add_function(std::uint32_t entry);
  [[nodiscard]] double cost_of(std::uint32_t entry, const CachedLoops& cached, std::uint32_t b);
  void conserve(std::uint32_t entry, std::uint32_t b);
  void connect_calls(const Entries& entries);

  const Analysis& analysis_;
  const NameValues& values_;
  BlockCosts costs_;
  LinearProgram& program_;
  std::map<std::uint32_t, FunctionVariables> variables_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, WorstPath> calls_;
};

}  // namespace tactree::wcet
