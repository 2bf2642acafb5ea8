#pragma once
// Points in the order of the Morton codes of their cells.

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <Eigen/Core>
#include <bit>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

#include "geometry/morton.hpp"

namespace tactree::builder {

struct KeyedPoint {
  std::uint64_t code;
  std::uint32_t index;
  bool operator<(const KeyedPoint& other) const {
    return code != other.code ? code < other.code : index < other.index;
  }
};

/// The points with the codes of the cells cell_of(position), in the order of the positions.
template <typename CellOf>
[[nodiscard]] std::vector<KeyedPoint> keyed_points(std::span<const Eigen::Vector3d> positions,
                                                   CellOf&& cell_of) {
  std::vector<KeyedPoint> points(positions.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, points.size(), 4096), [&](auto range) {
    for (std::size_t i = range.begin(); i < range.end(); ++i) {
      points[i] = {morton_code(cell_of(positions[i])), static_cast<std::uint32_t>(i)};
    }
  });
  return points;
}

/// The same, sorted by code, then by index.
template <typename CellOf>
[[nodiscard]] std::vector<KeyedPoint> sorted_points(std::span<const Eigen::Vector3d> positions,
                                                    CellOf&& cell_of) {
  std::vector<KeyedPoint> points = keyed_points(positions, cell_of);
  tbb::parallel_sort(points.begin(), points.end());
  return points;
}

/// Number of occupied cells of each level, from level 0, one cell around all, to kMortonLevels,
/// that of the codes. code_of(i) are `count` ascending codes. Cost: one pass.
template <typename CodeOf>
[[nodiscard]] std::vector<std::size_t> count_cells(std::size_t count, CodeOf&& code_of) {
  // By the coarsest level at which a point begins a cell; it then begins one at all finer levels.
  std::vector<std::size_t> counts(kMortonLevels + 1, 0);
  for (std::size_t i = 1; i < count; ++i) {
    const std::uint64_t differing = code_of(i) ^ code_of(i - 1);
    if (differing != 0) {
      ++counts[static_cast<std::size_t>(kMortonLevels - (63 - std::countl_zero(differing)) / 3)];
    }
  }
  counts[0] += count == 0 ? 0U : 1U;
  std::partial_sum(counts.begin(), counts.end(), counts.begin());
  return counts;
}

}  // namespace tactree::builder
