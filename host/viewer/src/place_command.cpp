#include "place_command.hpp"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "tactree/viewer/source.hpp"

namespace tactree::viewer {
namespace {

using nlohmann::json;

constexpr double kFarthest_m = 10.0;  // as core::is_valid(Pose), in either frame
constexpr double kSameScale = 1e-6;

double finite(const char* key, const json& value) {
  if (!value.is_number() || !std::isfinite(value.get<double>())) {
    throw SessionRefused(fmt::format("{}: not a number", key));
  }
  return value.get<double>();
}

}  // namespace

simulation::Placement placement_of(const json& command) {
  const json pose = command.value("pose", json());
  simulation::PoseRows rows{};
  if (!pose.is_array() || pose.size() != rows.size()) {
    throw SessionRefused("pose: not an array of 16 numbers, a 4x4 matrix row by row");
  }
  for (std::size_t i = 0; i < rows.size(); ++i) {
    rows[i] = finite("pose", pose[i]);
  }
  if (const auto problem = simulation::problem_of(rows)) {
    throw SessionRefused(fmt::format("pose: {} ({})", problem->cause, problem->remedy));
  }
  simulation::Placement placement{simulation::pose_of(rows), 1.0};
  if (!(placement.pose.translation().cwiseAbs().maxCoeff() <= 0.5 * kFarthest_m)) {
    throw SessionRefused(fmt::format("pose: outside +-{} m", 0.5 * kFarthest_m));
  }
  placement.scale = finite("scale", command.value("scale", json(1.0)));
  if (!(placement.scale >= simulation::kSmallestPlacedScale &&
        placement.scale <= simulation::kLargestPlacedScale)) {
    throw SessionRefused(fmt::format("scale: {:.6g} is outside {:.0e} .. {:.0e}", placement.scale,
                                     simulation::kSmallestPlacedScale,
                                     simulation::kLargestPlacedScale));
  }
  return placement;
}

bool is_same_scale(double a, double b) { return std::abs(a - b) <= kSameScale * b; }

}  // namespace tactree::viewer
