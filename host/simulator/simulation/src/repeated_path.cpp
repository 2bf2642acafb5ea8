#include "tactree/simulation/repeated_path.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>
#include <vector>

#include "tactree/plant/vectors.hpp"

namespace tactree::simulation {

HandPath repeated_path(std::span<const Sample> recorded) {
  const auto active = [](const Sample& s) { return s.status.state == core::State::kActive; };
  auto first = std::find_if(recorded.begin(), recorded.end(), [&](const Sample& s) {
    return active(s) && !s.status.rendering.in_contact;
  });
  if (first == recorded.end()) {
    first = std::find_if(recorded.begin(), recorded.end(), active);
  }
  if (first == recorded.end()) {
    throw std::invalid_argument(
        "no tick is in the state active, in which the hand feels the model");
  }
  std::vector<Waypoint> waypoints;
  for (auto sample = first; sample != recorded.end(); ++sample) {
    if (active(*sample)) {
      waypoints.push_back({sample->t_s - first->t_s, plant::widen(sample->status.probe)});
    }
  }
  return HandPath(std::move(waypoints));
}

}  // namespace tactree::simulation
