#pragma once
// max c x with x >= 0 and linear constraints, by GLPK.

#include <map>
#include <vector>

namespace tactree::bound {

/// Coefficients by variable.
using Terms = std::map<int, double>;

class LinearProgram {
 public:
  /// Its number; x >= 0.
  int add_variable(double gain);
  void add_gain(int variable, double gain) { gains_[static_cast<std::size_t>(variable)] += gain; }
  /// sum of the terms == value, or <= value.
  void equal(const Terms& terms, double value) { rows_.push_back({terms, value, true}); }
  void at_most(const Terms& terms, double value) { rows_.push_back({terms, value, false}); }

  struct Solution {
    bool bounded = false;
    double gain = 0.0;
    std::vector<double> x;
  };
  /// The largest gain, over real x: so never less than over integers.
  [[nodiscard]] Solution solve() const;

 private:
  struct Row {
    Terms terms;
    double value;
    bool equal;
  };
  std::vector<double> gains_;
  std::vector<Row> rows_;
};

}  // namespace tactree::bound
