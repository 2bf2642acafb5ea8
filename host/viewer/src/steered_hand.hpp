#pragma once
// The simulated hand that a page moves.

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "tactree/plant/plant.hpp"

namespace tactree::viewer {

/// Follows the targets of a page, which change 60 times a second, without steps.
class SteeredHand {
 public:
  explicit SteeredHand(const Eigen::Vector3d& at_m) : path_m_{at_m} { now_.position_m = at_m; }

  static constexpr double kFastest_m_s = 0.5;

  /// Moves through the points of `path_m` (model frame) in their order, at most at `speed_m_s`, and
  /// stays at the last point. Replaces the previous path. Preconditions: `path_m` is not empty;
  /// `speed_m_s` is above 0 and at most kFastest_m_s.
  void go(std::vector<Eigen::Vector3d> path_m, double speed_m_s = kFastest_m_s);

  /// Advances by `dt` seconds. The hand is fast on straight sections and slows down before sharp
  /// corners and the end.
  const plant::HandTarget& advance(double dt);

  [[nodiscard]] const Eigen::Vector3d& position_m() const { return now_.position_m; }

 private:
  [[nodiscard]] double distance_to_slow_point() const;

  std::vector<Eigen::Vector3d> path_m_;
  std::size_t next_ = 0;  ///< the point of path_m_ that the hand moves to
  double speed_m_s_ = kFastest_m_s;
  plant::HandTarget now_{};
};

}  // namespace tactree::viewer
