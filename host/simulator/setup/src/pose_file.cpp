#include "tactree/setup/pose_file.hpp"

#include <fmt/core.h>

#include <nlohmann/json.hpp>

#include "json_values.hpp"
#include "tactree/support/user_error.hpp"

namespace tactree::setup {
namespace {

constexpr double kFarthest_m = 10.0;  // as core::is_valid(Pose)

}  // namespace

simulation::Placement read_pose_file(const std::filesystem::path& file) {
  return placement_of(parse_file(file), file.string());
}

simulation::Placement placement_of(const nlohmann::json& root, const std::string& name) {
  require_keys(root, name, {"pose", "scale"});
  if (!root.contains("pose")) {
    support::refuse(name + ".pose", "is missing",
                    "write a 4x4 matrix, row by row, or save a pose on the page of tactree view");
  }
  simulation::Placement placement;
  placement.pose = pose(root["pose"], name + ".pose");
  if (!(placement.pose.translation().cwiseAbs().maxCoeff() <= kFarthest_m)) {
    support::refuse(name + ".pose",
                    fmt::format("its position is beyond +-{} m from the device", kFarthest_m),
                    "give it in metres, in the frame of the device");
  }
  if (root.contains("scale")) {
    placement.scale = number(root["scale"], name + ".scale");
    if (!(placement.scale >= simulation::kSmallestPlacedScale &&
          placement.scale <= simulation::kLargestPlacedScale)) {
      support::refuse(name + ".scale", fmt::format("{:.6g} is out of range", placement.scale),
                      fmt::format("give {:.0e} .. {:.0e}", simulation::kSmallestPlacedScale,
                                  simulation::kLargestPlacedScale));
    }
  }
  return placement;
}

}  // namespace tactree::setup
