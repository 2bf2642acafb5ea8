#pragma once
// All functions that the entry points reach, with their loops and bounds.

#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "control_flow.hpp"
#include "image.hpp"
#include "loop_bounds.hpp"
#include "source_code.hpp"

namespace tactree::wcet {

struct AnalysedFunction {
  ControlFlow flow;
  std::vector<LoopBound> bounds;  ///< of flow.loops
  /// Registers of the arguments that its bounds name. If there are any, each call is analysed
  /// separately.
  std::map<std::string, int> arguments;
};

class Program {
 public:
  /// Throws BoundError on recursion, and as control_flow() and find_loop_bounds() do.
  Program(const Image& image, SourceCode& sources, const std::vector<std::uint32_t>& entries);

  [[nodiscard]] const std::map<std::uint32_t, AnalysedFunction>& functions() const {
    return functions_;
  }
  [[nodiscard]] const AnalysedFunction& at(std::uint32_t entry) const {
    return functions_.at(entry);
  }
  [[nodiscard]] bool returns(std::uint32_t entry) const { return !never_return_.contains(entry); }
  /// Entries of functions that never return.
  [[nodiscard]] const std::set<std::uint32_t>& endings() const { return never_return_; }
  [[nodiscard]] Lines& lines() { return lines_; }

 private:
  void collect(const std::vector<std::uint32_t>& entries);
  void find_functions_that_return();
  [[nodiscard]] bool can_return(const ControlFlow& flow) const;
  void keep_reachable(const std::vector<std::uint32_t>& entries);
  void refuse_recursion(std::uint32_t entry, std::vector<std::uint32_t>& path,
                        std::set<std::uint32_t>& done) const;
  void find_arguments(std::uint32_t entry, AnalysedFunction& function) const;

  const Image& image_;
  Lines lines_;
  std::map<std::uint32_t, AnalysedFunction> functions_;
  std::set<std::uint32_t> never_return_;
};

}  // namespace tactree::wcet
