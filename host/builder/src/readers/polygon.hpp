#pragma once
// Triangulates polygons: convex ones as a fan around the first vertex, others by ear clipping, so
// that no triangle covers area outside the polygon.

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace tactree::builder {

class PolygonCutter {
 public:
  using Triangle = std::array<std::uint32_t, 3>;

  explicit PolygonCutter(const std::vector<Eigen::Vector3d>& positions) : positions_(positions) {}

  /// Returns the triangles of the polygon with these vertices (three or more, each an index into
  /// the positions), in its winding. They are valid until the next call. n vertices give n - 2
  /// triangles. Cost: n for a convex polygon, up to n^3 for any other, bounded over all calls.
  /// Beyond the bound, every polygon is cut as a fan.
  [[nodiscard]] std::span<const Triangle> cut(std::span<const std::uint32_t> corners);

  /// True if the bound on the cost was reached.
  [[nodiscard]] bool gave_up() const { return work_left_ == 0; }

 private:
  void project(std::span<const std::uint32_t> corners);
  [[nodiscard]] bool is_convex() const;
  void cut_fan(std::span<const std::uint32_t> corners);
  void clip_ears(std::span<const std::uint32_t> corners);
  [[nodiscard]] bool is_ear(std::size_t at);

  const std::vector<Eigen::Vector3d>& positions_;
  std::uint64_t work_left_ = 1'000'000'000;
  std::vector<Eigen::Vector2d> flat_;  // vertices in the plane, counter-clockwise
  std::vector<std::uint32_t> left_;    // vertices not clipped yet, as indices into flat_
  std::vector<Triangle> triangles_;
};

}  // namespace tactree::builder
