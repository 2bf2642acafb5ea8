#pragma once
// Path of the hand: its target position as a function of time.

#include <Eigen/Core>
#include <vector>

#include "tactree/plant/plant.hpp"

namespace tactree::simulation {

struct Waypoint {
  double t_s = 0.0;
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();  ///< model frame
};

/// The hand moves in straight lines between waypoints; it rests before the first and after the
/// last.
class HandPath {
 public:
  /// Throws std::invalid_argument if there is no waypoint, one is not finite, or the times do not
  /// ascend.
  explicit HandPath(std::vector<Waypoint> waypoints);

  /// Cost: a binary search for the waypoint.
  [[nodiscard]] plant::HandTarget at(double t_s) const;
  [[nodiscard]] const std::vector<Waypoint>& waypoints() const { return waypoints_; }

 private:
  std::vector<Waypoint> waypoints_;
};

}  // namespace tactree::simulation
