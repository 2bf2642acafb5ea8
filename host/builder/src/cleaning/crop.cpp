#include "cleaning/crop.hpp"

#include <vector>

namespace tactree::builder {
namespace {

using Polygon = std::vector<Eigen::Vector3d>;

/// The part of a convex polygon in which sign * coordinate >= sign * limit.
Polygon clipped(const Polygon& polygon, Eigen::Index axis, double sign, double limit) {
  Polygon kept;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector3d& a = polygon[i];
    const Eigen::Vector3d& b = polygon[(i + 1) % polygon.size()];
    const double from = sign * (a[axis] - limit);
    const double to = sign * (b[axis] - limit);
    if (from >= 0.0) {
      kept.push_back(a);
    }
    if ((from < 0.0) != (to < 0.0)) {
      kept.emplace_back(a + from / (from - to) * (b - a));
      kept.back()[axis] = limit;
    }
  }
  return kept;
}

}  // namespace

Box cropped_bounds(const std::array<Eigen::Vector3d, 3>& triangle, const Crop& crop) {
  Polygon polygon;
  for (const Eigen::Vector3d& corner : triangle) {
    polygon.emplace_back(crop.turn.transpose() * corner);
  }
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    polygon = clipped(polygon, axis, 1.0, crop.box.min()[axis]);
    polygon = clipped(polygon, axis, -1.0, crop.box.max()[axis]);
  }
  Box bounds;
  for (const Eigen::Vector3d& corner : polygon) {
    bounds.extend(crop.turn * corner);
  }
  return bounds;
}

}  // namespace tactree::builder
