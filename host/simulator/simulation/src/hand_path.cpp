#include "tactree/simulation/hand_path.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <stdexcept>
#include <utility>

namespace tactree::simulation {
HandPath::HandPath(std::vector<Waypoint> waypoints) : waypoints_(std::move(waypoints)) {
  if (waypoints_.empty()) {
    throw std::invalid_argument("a hand's path needs at least one waypoint");
  }
  for (std::size_t i = 0; i < waypoints_.size(); ++i) {
    const Waypoint& w = waypoints_[i];
    if (!std::isfinite(w.t_s) || !w.position_m.allFinite()) {
      throw std::invalid_argument("a waypoint is not finite");
    }
    if (i > 0 && !(w.t_s > waypoints_[i - 1].t_s)) {
      throw std::invalid_argument("the time of the waypoints does not ascend");
    }
  }
}

plant::HandTarget HandPath::at(double t_s) const {
  const auto after = std::upper_bound(waypoints_.begin(), waypoints_.end(), t_s,
                                      [](double t, const Waypoint& w) { return t < w.t_s; });
  if (after == waypoints_.begin()) {
    return {waypoints_.front().position_m, Eigen::Vector3d::Zero()};
  }
  if (after == waypoints_.end()) {
    return {waypoints_.back().position_m, Eigen::Vector3d::Zero()};
  }
  const Waypoint& before = *std::prev(after);
  const Eigen::Vector3d velocity =
      (after->position_m - before.position_m) / (after->t_s - before.t_s);
  return {before.position_m + (t_s - before.t_s) * velocity, velocity};
}

}  // namespace tactree::simulation
