#include "cleaning/pieces.hpp"

#include <algorithm>
#include <numeric>

#include "geometry/disjoint_sets.hpp"

namespace tactree::builder {
namespace {

// Joins occupied cells that touch. `cells` are in Z order, as ZOrderedCloud::cells() returns them.
DisjointSets joined_cells(const ZOrderedCloud& points, const std::vector<CellRange>& cells,
                          int level) {
  DisjointSets sets(cells.size());
  const auto cell_of_first = [&](std::uint32_t first) {
    const auto found =
        std::lower_bound(cells.begin(), cells.end(), first,
                         [](const CellRange& cell, std::uint32_t at) { return cell.first < at; });
    return static_cast<std::uint32_t>(found - cells.begin());
  };
  const int per_axis = 1 << level;
  for (std::uint32_t c = 0; c < cells.size(); ++c) {
    const Eigen::Vector3i cell = points.cell_of(cells[c].first, level);
    for (int k = 14; k < 27; ++k) {  // the other neighbours join from their side
      const Eigen::Vector3i at = cell + Eigen::Vector3i(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1);
      if ((at.array() >= 0).all() && (at.array() < per_axis).all()) {
        const CellRange other = points.find(at, level);
        if (other.count() > 0) {
          sets.join(c, cell_of_first(other.first));
        }
      }
    }
  }
  return sets;
}

// Per set, whether the rule keeps it. `root` is the set of each member, `weight` its points.
std::vector<bool> kept_sets(std::span<const std::uint32_t> root,
                            std::span<const std::uint64_t> weight, const PieceRule& rule) {
  std::vector<std::uint64_t> size(root.size(), 0);
  for (std::size_t i = 0; i < root.size(); ++i) {
    size[root[i]] += weight[i];
  }
  const auto largest = std::max_element(size.begin(), size.end()) - size.begin();
  std::vector<bool> kept(root.size());
  for (std::size_t s = 0; s < size.size(); ++s) {
    kept[s] = rule.only_largest ? static_cast<std::ptrdiff_t>(s) == largest
                                : size[s] >= rule.least_points;
  }
  return kept;
}

}  // namespace

std::vector<std::uint32_t> first_equal(std::span<const Eigen::Vector3d> p) {
  std::vector<std::uint32_t> order(p.size());
  std::iota(order.begin(), order.end(), 0U);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    for (int axis = 0; axis < 3; ++axis) {
      if (p[a][axis] != p[b][axis]) {
        return p[a][axis] < p[b][axis];
      }
    }
    return a < b;
  });
  std::vector<std::uint32_t> same(p.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool first = i == 0 || p[order[i]] != p[order[i - 1]];
    same[order[i]] = first ? order[i] : same[order[i - 1]];
  }
  return same;
}

std::vector<std::uint32_t> kept_points(const ZOrderedCloud& points, double reach,
                                       const PieceRule& rule) {
  const int level = points.level_for_edge(reach);
  const std::vector<CellRange> cells = points.cells(level);
  DisjointSets sets = joined_cells(points, cells, level);
  std::vector<std::uint32_t> root(cells.size());
  std::vector<std::uint64_t> weight(cells.size());
  for (std::uint32_t c = 0; c < cells.size(); ++c) {
    root[c] = sets.find(c);
    weight[c] = cells[c].count();
  }
  const std::vector<bool> kept = kept_sets(root, weight, rule);
  std::vector<std::uint32_t> indices;
  for (std::uint32_t c = 0; c < cells.size(); ++c) {
    for (std::uint32_t i = cells[c].first; i < cells[c].last && kept[root[c]]; ++i) {
      indices.push_back(i);
    }
  }
  return indices;
}

std::vector<bool> kept_corners(const Mesh& mesh, const PieceRule& rule) {
  const std::vector<std::uint32_t> same = first_equal(mesh.positions);
  DisjointSets sets(mesh.positions.size());
  std::vector<std::uint64_t> weight(mesh.positions.size(), 0);
  for (const auto& triangle : mesh.triangles) {
    for (const std::uint32_t corner : triangle) {
      sets.join(same[triangle[0]], same[corner]);
      weight[same[corner]] = 1;
    }
  }
  std::vector<std::uint32_t> root(mesh.positions.size());
  for (std::uint32_t i = 0; i < root.size(); ++i) {
    root[i] = sets.find(same[i]);
  }
  const std::vector<bool> kept = kept_sets(root, weight, rule);
  std::vector<bool> corners(root.size());
  for (std::size_t i = 0; i < root.size(); ++i) {
    corners[i] = kept[root[i]] || (weight[same[i]] == 0);
  }
  return corners;
}

}  // namespace tactree::builder
