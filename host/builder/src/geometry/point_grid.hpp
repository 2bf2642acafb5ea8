#pragma once
// Points sorted into the cells of a regular grid: finds neighbours within about one cell edge in
// constant time. Memory: only for occupied cells.

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "geometry/morton.hpp"

namespace tactree::builder {

class PointGrid {
 public:
  /// Preconditions: finite positions, at most 2^32 - 2 of them; cell_edge > 0. The edge is enlarged
  /// to limit the grid to 2^20 cells per axis. Deterministic. Cost: one sort; 16 bytes per point
  /// during construction, then 4 per point and 16 per cell.
  PointGrid(std::span<const Eigen::Vector3d> positions, double cell_edge);

  [[nodiscard]] double cell_edge() const { return edge_; }
  [[nodiscard]] std::size_t cell_count() const { return codes_.size(); }
  /// The points of an occupied cell, ascending. Cells are in Z-curve order.
  [[nodiscard]] std::span<const std::uint32_t> points_of(std::size_t cell) const {
    return std::span(order_).subspan(first_[cell], first_[cell + 1] - first_[cell]);
  }
  /// All points, cell by cell.
  [[nodiscard]] std::span<const std::uint32_t> order() const { return order_; }

  /// Precondition: in the bounds of the points, so that the conversion rounds down.
  [[nodiscard]] Eigen::Vector3i cell_at(const Eigen::Vector3d& position) const {
    return ((position - origin_) / edge_).cast<int>();
  }
  [[nodiscard]] Eigen::Vector3i cell_coordinates(std::size_t cell) const {
    return morton_cell(codes_[cell]);
  }
  [[nodiscard]] Eigen::Vector3d cell_centre(const Eigen::Vector3i& cell) const {
    return origin_ + edge_ * (cell.cast<double>() + Eigen::Vector3d::Constant(0.5));
  }

  static constexpr std::size_t kNone = ~std::size_t{0};
  /// Index of the occupied cell at these coordinates, or kNone.
  [[nodiscard]] std::size_t find(const Eigen::Vector3i& cell) const;

  /// Calls visit(index) for every point in the cells that the cube centre +- radius touches: all
  /// points within the radius, and some beyond. Order: cell by cell, x fastest.
  template <typename Visit>
  void visit_near(const Eigen::Vector3d& centre, double radius, Visit&& visit) const {
    const Eigen::Vector3i low = clamped_cell(centre.array() - radius, 0);
    const Eigen::Vector3i high = clamped_cell(centre.array() + radius, -1);
    for (int z = low.z(); z <= high.z(); ++z) {
      for (int y = low.y(); y <= high.y(); ++y) {
        for (int x = low.x(); x <= high.x(); ++x) {
          const std::size_t cell = find({x, y, z});
          if (cell == kNone) {
            continue;
          }
          for (const std::uint32_t index : points_of(cell)) {
            visit(index);
          }
        }
      }
    }
  }

 private:
  [[nodiscard]] Eigen::Vector3i clamped_cell(const Eigen::Vector3d& position, int beyond) const;

  Eigen::Vector3d origin_ = Eigen::Vector3d::Zero();
  Eigen::Vector3i size_ = Eigen::Vector3i::Zero();  // cells on each axis
  double edge_ = 1.0;
  std::vector<std::uint32_t> order_;
  std::vector<std::uint64_t> codes_;  // of the occupied cells, ascending
  std::vector<std::uint32_t> first_;  // cell -> begin in order_; one entry more than cells
  std::vector<std::uint32_t> table_;  // open addressing: cell number + 1, or 0
};

}  // namespace tactree::builder
