#pragma once
// Statistics of errors.

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numbers>
#include <vector>

namespace tactree::evaluation {

inline constexpr double kNotMeasured = std::numeric_limits<double>::quiet_NaN();

/// Root mean square and maximum magnitude of a series of errors.
class Errors {
 public:
  void add(double error) {
    sum_squared_ += error * error;
    largest_ = std::max(largest_, std::abs(error));
    ++count_;
  }
  [[nodiscard]] double rms() const {
    return count_ == 0 ? kNotMeasured : std::sqrt(sum_squared_ / static_cast<double>(count_));
  }
  [[nodiscard]] double largest() const { return count_ == 0 ? kNotMeasured : largest_; }
  [[nodiscard]] std::uint64_t count() const { return count_; }

 private:
  double sum_squared_ = 0.0;
  double largest_ = 0.0;
  std::uint64_t count_ = 0;
};

/// The value that this part of the values does not exceed. Reorders them; 0 if there are none.
inline double quantile(std::vector<double>& values, double part) {
  if (values.empty()) {
    return 0.0;
  }
  const double last = part * static_cast<double>(values.size() - 1);
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(std::ceil(last));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/// Angle between two directions, degrees.
inline double angle_deg(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b)) * 180.0 / std::numbers::pi;
}

}  // namespace tactree::evaluation
