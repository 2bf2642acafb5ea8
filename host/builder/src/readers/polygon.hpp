#pragma once
// Triangulates polygons: convex ones as a fan around the first corner, others by ear clipping, so
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

  /// The triangles of the polygon with these corners (three or more, each an index into the
  /// positions), in its winding. Valid until the next call. n corners give n - 2 triangles.
  /// Cost: n^2 for a convex, n^3 for another polygon, bounded over all calls: beyond the bound,
  /// every polygon is cut as a fan.
  [[nodiscard]] std::span<const Triangle> cut(std::span<const std::uint32_t> corners);

  /// Whether the bound on the cost was reached.
  [[nodiscard]] bool gave_up() const { return work_left_ == 0; }

 private:
  void project(std::span<const std::uint32_t> corners);
  [[nodiscard]] bool is_convex() const;
  void cut_fan(std::span<const std::uint32_t> corners);
  void clip_ears(std::span<const std::uint32_t> corners);
  [[nodiscard]] bool is_ear(std::size_t at);

  const std::vector<Eigen::Vector3d>& positions_;
  std::uint64_t work_left_ = 1'000'000'000;
  std::vector<Eigen::Vector2d> flat_;  // the corners in the polygon's plane, counter-clockwise
  std::vector<std::uint32_t> left_;    // corners not clipped yet, as indices into flat_
  std::vector<Triangle> triangles_;
};

}  // namespace tactree::builder
