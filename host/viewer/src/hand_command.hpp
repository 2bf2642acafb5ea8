#pragma once
// The "hand" command of a page: see live_session.hpp.

#include <Eigen/Core>
#include <nlohmann/json_fwd.hpp>
#include <vector>

namespace tactree::viewer {

/// The points that the hand passes, and its maximum speed. Both throw SessionRefused.
[[nodiscard]] std::vector<Eigen::Vector3d> path_of(const nlohmann::json& command);
[[nodiscard]] double speed_of(const nlohmann::json& command);

}  // namespace tactree::viewer
