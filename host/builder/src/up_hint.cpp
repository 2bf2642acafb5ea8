#include "up_hint.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>

#include "geometry/cloud.hpp"

namespace tactree::builder {
namespace {

constexpr float kLevelCosine = 0.996F;       // 5 degrees
constexpr double kDepthSpacings = 1.5;       // maximum distance from the end of the box
constexpr double kDepthOfEdge = 0.005;       // or this, in lengths of its longest edge
constexpr double kMinShare = 0.04;           // minimum ratio of the points that lie on the base
constexpr double kMaxShare = 0.6;            // above: a plate, whose base is no evidence
constexpr double kTimesTheNext = 3.0;        // the base / the flat part at any other end
constexpr std::size_t kMinHintPoints = 500;  // of fewer points, 4 % are noise

}  // namespace

std::optional<FlatBase> flat_base(std::span<const Eigen::Vector3d> positions,
                                  std::span<const Eigen::Vector3f> normals, double spacing) {
  if (positions.size() < kMinHintPoints || normals.size() != positions.size()) {
    return std::nullopt;
  }
  const Box box = bounds_of(positions);
  const double depth = std::max(kDepthSpacings * spacing, kDepthOfEdge * largest_edge(box));
  std::array<double, 6> flat{};  // low x, y, z, high x, y, z
  for (std::size_t i = 0; i < positions.size(); ++i) {
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      const float along = normals[i][axis];
      const double above = positions[i][axis] - box.min()[axis];
      const double below = box.max()[axis] - positions[i][axis];
      const auto at = static_cast<std::size_t>(axis);
      flat[at] += along < -kLevelCosine && above <= depth ? 1.0 : 0.0;
      flat[at + 3] += along > kLevelCosine && below <= depth ? 1.0 : 0.0;
    }
  }
  const auto best =
      static_cast<std::size_t>(std::max_element(flat.begin(), flat.end()) - flat.begin());
  const double points = flat[best];
  flat[best] = 0.0;
  const double share = points / static_cast<double>(positions.size());
  if (best >= 3 || share < kMinShare || share > kMaxShare ||
      points < kTimesTheNext * *std::max_element(flat.begin(), flat.end())) {
    return std::nullopt;
  }
  constexpr std::array<UpAxis, 3> kAxes = {UpAxis::kX, UpAxis::kY, UpAxis::kZ};
  return FlatBase{kAxes[best], share};
}

char letter_of(UpAxis axis) { return "xyz"[static_cast<std::size_t>(axis)]; }

std::string describe_lying(const FlatBase& base) {
  return fmt::format(
      "the model seems to lie on its side: its flat base, {:.0f} % of the surface, is at its "
      "lowest "
      "{}",
      100.0 * base.share, letter_of(base.up));
}

}  // namespace tactree::builder
