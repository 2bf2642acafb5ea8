#pragma once
// Thins points while they are read: keeps one in each cube of a grid.

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace tactree::builder {

/// The edge of the cubes is a power of two in the unit of the points, and a corner of the grid is
/// the origin. The cubes of a later call are therefore those of an earlier one, or consist of whole
/// ones, and a list that is thinned again as it grows is as dense everywhere as if it had been
/// thinned at once.
class GridThinning {
 public:
  /// Tells for each point whether it is kept: the first of each cube, and at most `most`. The cubes
  /// have the smallest possible edge, but not a smaller one than in the last call. Single points
  /// far from all others do not enlarge them. Precondition: finite positions, most > 0.
  /// Deterministic. Cost: one sort; 17 bytes per point.
  [[nodiscard]] std::vector<std::uint8_t> select(std::span<const Eigen::Vector3d> positions,
                                                 std::size_t most);

  /// Edge of the cubes of the last call.
  [[nodiscard]] double edge() const;

 private:
  std::optional<int> exponent_;  // of two: the edge
};

}  // namespace tactree::builder
