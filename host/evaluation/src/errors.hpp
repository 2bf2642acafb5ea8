#pragma once
// Statistics of errors.

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>

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

/// Angle between two directions, degrees.
inline double angle_deg(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b)) * 180.0 / std::numbers::pi;
}

}  // namespace tactree::evaluation
