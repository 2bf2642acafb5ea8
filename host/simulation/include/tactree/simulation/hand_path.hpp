#pragma once
// The way of the hand: where it wants to be at each time.

#include <Eigen/Core>
#include <filesystem>
#include <vector>

#include "tactree/plant/plant.hpp"

namespace tactree::simulation {

struct Waypoint {
  double t_s = 0.0;
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();  ///< model frame
};

/// Straight lines between waypoints; before the first and after the last the hand rests.
class HandPath {
 public:
  /// Throws std::invalid_argument unless there is a waypoint, all are finite and time ascends.
  explicit HandPath(std::vector<Waypoint> waypoints);

  /// Cost: one step for times in ascending order, else a search.
  [[nodiscard]] plant::HandTarget at(double t_s) const;
  [[nodiscard]] const std::vector<Waypoint>& waypoints() const { return waypoints_; }

 private:
  std::vector<Waypoint> waypoints_;
};

/// Reads rows `t_s,x,y,z` (s, m); a first row that is no number is a heading; empty rows and rows
/// that begin with # do not count. Throws std::runtime_error: "file: line n: cause (remedy)".
[[nodiscard]] HandPath read_hand_path(const std::filesystem::path& file);

}  // namespace tactree::simulation
