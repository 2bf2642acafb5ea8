#pragma once
// Errors of many samples.

#include <algorithm>
#include <cmath>

namespace tactree::test {

/// Root mean square and largest of a series of errors.
struct Errors {
  double sum_squared = 0.0;
  double largest = 0.0;
  int count = 0;
  void add(double error) {
    sum_squared += error * error;
    largest = std::max(largest, std::abs(error));
    ++count;
  }
  [[nodiscard]] double rms() const { return std::sqrt(sum_squared / count); }
};

}  // namespace tactree::test
