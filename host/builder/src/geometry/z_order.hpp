#pragma once
// Points sorted along a Z curve. Each cell of an octree over them, at any level, is a range of
// consecutive points that a binary search finds, so neighbour queries at any scale need no tree.

#include <Eigen/Core>
#include <algorithm>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "geometry/cloud.hpp"
#include "geometry/morton.hpp"

namespace tactree::builder {

/// Consecutive points [first, last) in one cell.
struct CellRange {
  std::uint32_t first = 0;
  std::uint32_t last = 0;
  [[nodiscard]] std::uint32_t count() const { return last - first; }
};

struct Neighbour {
  double squared_distance;
  std::uint32_t index;
  bool operator<(const Neighbour& other) const {
    return squared_distance != other.squared_distance ? squared_distance < other.squared_distance
                                                      : index < other.index;
  }
};

/// Keeps the `count` nearest (or all, if there are fewer) in any order; of equal distances those of
/// the lowest indices.
void keep_nearest(std::size_t count, std::vector<Neighbour>& found);

/// A cloud in Z order. Preconditions: finite positions, at most 2^32 - 2 of them. Only keep(),
/// transform(), set_normals() and take() modify it.
class ZOrderedCloud {
 public:
  static constexpr int kFinestLevel = kMortonLevels;

  ZOrderedCloud() = default;
  /// Sorts the cloud in place. Takes 20 bytes a point while it sorts, 8 then. Deterministic: points
  /// of one finest cell are ordered by coordinates, then by index.
  explicit ZOrderedCloud(Cloud cloud);

  [[nodiscard]] const Cloud& cloud() const { return cloud_; }
  [[nodiscard]] const std::vector<Eigen::Vector3d>& positions() const { return cloud_.positions; }
  [[nodiscard]] const std::vector<Eigen::Vector3f>& normals() const { return cloud_.normals; }
  [[nodiscard]] std::size_t size() const { return cloud_.size(); }

  /// Returns the points at `indices`, which must ascend. Does not sort.
  [[nodiscard]] ZOrderedCloud subset(std::span<const std::uint32_t> indices) const;
  /// Drops the points that are not at `indices`, which must ascend. Takes no memory.
  void keep(std::span<const std::uint32_t> indices);
  /// Replaces each position by factor * (position - origin).
  void transform(const Eigen::Vector3d& origin, double factor);
  void set_normals(std::vector<Eigen::Vector3f> normals) { cloud_.normals = std::move(normals); }
  /// Returns the points; none are left.
  [[nodiscard]] Cloud take() {
    ZOrderedCloud all;
    std::swap(all, *this);
    return std::move(all.cloud_);
  }

  /// Edge of the cells of a level; level 0 is one cell around all points.
  [[nodiscard]] double cell_edge(int level) const;
  /// The finest level whose cells have at least this edge.
  [[nodiscard]] int level_for_edge(double edge) const;
  /// The occupied cells of a level, in Z order.
  [[nodiscard]] std::vector<CellRange> cells(int level) const;
  [[nodiscard]] Eigen::Vector3i cell_of(std::uint32_t point, int level) const;
  [[nodiscard]] CellRange find(const Eigen::Vector3i& cell, int level) const;
  [[nodiscard]] Eigen::Vector3d cell_corner(const Eigen::Vector3i& cell, int level) const {
    return origin_ + cell_edge(level) * cell.cast<double>();
  }

  /// Number of occupied cells of each level. Cost: one pass.
  [[nodiscard]] std::vector<std::size_t> count_cells() const;

  /// Calls visit(range) for the cells of a level that the box [low, high] touches, x fastest.
  template <typename Visit>
  void visit_cells(const Eigen::Vector3d& low, const Eigen::Vector3d& high, int level,
                   Visit&& visit) const {
    const int shift = kFinestLevel - level;
    const Eigen::Vector3i first = finest_cell(low);
    const Eigen::Vector3i last = finest_cell(high);
    for (int z = first.z() >> shift; z <= last.z() >> shift; ++z) {
      for (int y = first.y() >> shift; y <= last.y() >> shift; ++y) {
        for (int x = first.x() >> shift; x <= last.x() >> shift; ++x) {
          visit(find({x, y, z}, level));
        }
      }
    }
  }

  /// Calls visit(index, squared_distance) for every point within `radius` of `centre`, in a fixed
  /// order.
  template <typename Visit>
  void visit_within(const Eigen::Vector3d& centre, double radius, Visit&& visit) const {
    // At this level, few cells must be searched and few of their points lie outside the radius.
    const int level = level_for_edge(2.0 * radius);
    const double squared_radius = radius * radius;
    visit_cells(centre.array() - radius, centre.array() + radius, level, [&](CellRange range) {
      for (std::uint32_t i = range.first; i < range.last; ++i) {
        const double squared = (cloud_.positions[i] - centre).squaredNorm();
        if (squared <= squared_radius) {
          visit(i, squared);
        }
      }
    });
  }

  /// Returns the `count` nearest points (or all, if there are fewer), nearest first, ties by index.
  /// `guess` is the estimated distance of the last one and influences the time only.
  void find_nearest(const Eigen::Vector3d& centre, std::size_t count, double guess,
                    std::vector<Neighbour>& found) const;
  /// The same points in any order.
  void find_nearest_unsorted(const Eigen::Vector3d& centre, std::size_t count, double guess,
                             std::vector<Neighbour>& found) const;

 private:
  [[nodiscard]] Eigen::Vector3i finest_cell(const Eigen::Vector3d& position) const;
  /// The indices of the points in Z order, before they have codes.
  [[nodiscard]] std::vector<std::uint32_t> sorted() const;
  void index();

  Cloud cloud_;
  Eigen::Vector3d origin_ = Eigen::Vector3d::Zero();
  double edge_ = 1.0;  // of level 0
  std::vector<std::uint64_t> codes_;
  // The first point of each cell of a coarse level, occupied or not, and the number of points.
  std::vector<std::uint32_t> coarse_ = {0, 0};
  int coarse_level_ = 0;
};

/// Keeps one of several points with equal coordinates, if possible one with a normal.
/// Returns the number of points dropped.
std::uint64_t drop_duplicates(ZOrderedCloud& points);

}  // namespace tactree::builder
