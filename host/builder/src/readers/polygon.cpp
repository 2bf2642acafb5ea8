#include "polygon.hpp"

#include <Eigen/Geometry>
#include <algorithm>

namespace tactree::builder {
namespace {

/// Twice the signed area of the triangle a b c.
double turn(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
  return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

}  // namespace

std::span<const PolygonCutter::Triangle> PolygonCutter::cut(
    std::span<const std::uint32_t> corners) {
  triangles_.clear();
  if (corners.size() == 3 || gave_up()) {
    cut_fan(corners);
    return triangles_;
  }
  project(corners);
  if (is_convex()) {
    cut_fan(corners);
  } else {
    clip_ears(corners);
  }
  return triangles_;
}

/// Projects along the largest component of the normal (Newell), which preserves the side of every
/// point relative to every edge.
void PolygonCutter::project(std::span<const std::uint32_t> corners) {
  const Eigen::Vector3d origin = positions_[corners[0]];
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  Eigen::Vector3d previous = positions_[corners.back()] - origin;
  for (const std::uint32_t corner : corners) {
    const Eigen::Vector3d current = positions_[corner] - origin;
    normal += previous.cross(current);
    previous = current;
  }
  Eigen::Index axis = 0;
  normal.cwiseAbs().maxCoeff(&axis);
  const Eigen::Index u = (axis + 1) % 3;
  const Eigen::Index v = (axis + 2) % 3;
  const double sign = normal[axis] < 0 ? -1.0 : 1.0;
  flat_.clear();
  for (const std::uint32_t corner : corners) {
    const Eigen::Vector3d from_origin = positions_[corner] - origin;
    flat_.emplace_back(from_origin[u], sign * from_origin[v]);
  }
}

/// True if the polygon turns left at every vertex.
bool PolygonCutter::is_convex() const {
  const std::size_t count = flat_.size();
  for (std::size_t i = 0; i < count; ++i) {
    if (turn(flat_[i], flat_[(i + 1) % count], flat_[(i + 2) % count]) < 0) return false;
  }
  return true;
}

void PolygonCutter::cut_fan(std::span<const std::uint32_t> corners) {
  for (std::size_t i = 2; i < corners.size(); ++i) {
    triangles_.push_back({corners[0], corners[i - 1], corners[i]});
  }
}

bool PolygonCutter::is_ear(std::size_t at) {
  const std::size_t count = left_.size();
  const std::uint32_t before = left_[(at + count - 1) % count];
  const std::uint32_t here = left_[at];
  const std::uint32_t after = left_[(at + 1) % count];
  const Eigen::Vector2d &a = flat_[before], &b = flat_[here], &c = flat_[after];
  if (!(turn(a, b, c) > 0)) return false;
  work_left_ -= std::min<std::uint64_t>(work_left_, count);
  for (const std::uint32_t other : left_) {
    const Eigen::Vector2d& p = flat_[other];
    if (p == a || p == b || p == c) continue;
    if (turn(a, b, p) >= 0 && turn(b, c, p) >= 0 && turn(c, a, p) >= 0) return false;
  }
  return true;
}

void PolygonCutter::clip_ears(std::span<const std::uint32_t> corners) {
  left_.clear();
  for (std::size_t i = 0; i < corners.size(); ++i) left_.push_back(static_cast<std::uint32_t>(i));
  std::size_t at = 0;
  std::size_t tried = 0;
  while (left_.size() > 3) {
    // A polygon that crosses itself may have no ear. Any vertex is then clipped, so that this ends.
    const bool clip = tried >= left_.size() || gave_up() || is_ear(at);
    const std::size_t count = left_.size();
    if (!clip) {
      at = (at + 1) % count;
      ++tried;
      continue;
    }
    triangles_.push_back({corners[left_[(at + count - 1) % count]], corners[left_[at]],
                          corners[left_[(at + 1) % count]]});
    left_.erase(left_.begin() + static_cast<std::ptrdiff_t>(at));
    if (at == left_.size()) at = 0;
    tried = 0;
  }
  triangles_.push_back({corners[left_[0]], corners[left_[1]], corners[left_[2]]});
}

}  // namespace tactree::builder
