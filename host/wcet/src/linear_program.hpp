#pragma once
// Maximises c x subject to x >= 0 and linear constraints, with GLPK.

#include <cstddef>
#include <map>
#include <utility>
#include <vector>

namespace tactree::wcet {

/// Coefficients by variable.
using Terms = std::map<int, double>;

/// to += factor * terms.
inline void add_terms(Terms& to, const Terms& terms, double factor = 1.0) {
  for (const auto& [variable, coefficient] : terms) {
    to[variable] += factor * coefficient;
  }
}

class LinearProgram {
 public:
  /// Adds a variable x >= 0 with this coefficient in the objective. Returns its number.
  int add_variable(double gain);
  [[nodiscard]] const std::vector<double>& gains() const { return gains_; }
  void set_gains(std::vector<double> gains) { gains_ = std::move(gains); }
  /// Adds the constraint that the sum of the terms == value, or <= value. Returns the number of the
  /// row.
  std::size_t equal(const Terms& terms, double value) { return add({terms, value, true}); }
  std::size_t at_most(const Terms& terms, double value) { return add({terms, value, false}); }
  void replace(std::size_t row, const Terms& terms) { rows_[row].terms = terms; }

  struct Solution {
    bool bounded = false;  ///< false: no optimum was found, and the rest is empty
    double gain = 0.0;
    std::vector<double> x;
    std::vector<double> price;  ///< by row: its dual value
  };
  /// The optimum over real x, which is not less than over integers.
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

}  // namespace tactree::wcet
