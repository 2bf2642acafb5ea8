#pragma once
// max c x with x >= 0 and linear constraints, by GLPK.

#include <cstddef>
#include <map>
#include <utility>
#include <vector>

namespace tactree::bound {

/// Coefficients by variable.
using Terms = std::map<int, double>;

class LinearProgram {
 public:
  /// Its number; x >= 0.
  int add_variable(double gain);
  [[nodiscard]] const std::vector<double>& gains() const { return gains_; }
  void set_gains(std::vector<double> gains) { gains_ = std::move(gains); }
  /// sum of the terms == value, or <= value; the number of the row.
  std::size_t equal(const Terms& terms, double value) { return add({terms, value, true}); }
  std::size_t at_most(const Terms& terms, double value) { return add({terms, value, false}); }
  void replace(std::size_t row, const Terms& terms) { rows_[row].terms = terms; }

  struct Solution {
    bool bounded = false;
    double gain = 0.0;
    std::vector<double> x;
    std::vector<double> price;  ///< by row: what a larger value would gain
  };
  /// The largest gain, over real x: so never less than over integers.
  [[nodiscard]] Solution solve() const;

 private:
  struct Row {
    Terms terms;
    double value;
    bool equal;
  };
  std::size_t add(Row row) {
    rows_.push_back(std::move(row));
    return rows_.size() - 1;
  }

  std::vector<double> gains_;
  std::vector<Row> rows_;
};

}  // namespace tactree::bound
