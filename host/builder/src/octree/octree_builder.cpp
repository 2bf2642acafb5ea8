#include "octree/octree_builder.hpp"

#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cmath>

#include "geometry/morton.hpp"
#include "octree/rounding.hpp"
#include "tactree/core/model/octree.hpp"

namespace tactree::builder {
namespace {

using core::Int3;

// Morton code of a point's site at the finest level, counted from the root. Sorting by it sorts by
// octant at every level.
struct Keyed {
  std::uint64_t key;
  std::uint32_t index;
  friend bool operator<(const Keyed& a, const Keyed& b) {
    return a.key != b.key ? a.key < b.key : a.index < b.index;
  }
};

std::vector<Keyed> sorted_keys(std::span<const Eigen::Vector3d> positions,
                               std::span<const Eigen::Vector3f> normals, const Lattice& lattice) {
  const Eigen::Vector3d root(lattice.root_min.x, lattice.root_min.y, lattice.root_min.z);
  const auto last = static_cast<int>((std::int64_t{core::kLeafUnits / 2} << lattice.depth) - 1);
  std::vector<Keyed> keys(positions.size());
  const auto set_key = [&](std::size_t i) {
    const Eigen::Vector3d at = 0.5 * (positions[i] / lattice.step_m - root);
    const Eigen::Vector3d normal =
        normals.empty() ? Eigen::Vector3d(Eigen::Vector3d::Zero()) : normals[i].cast<double>();
    keys[i] = {morton_code(site_on_plane(at, normal, last)), static_cast<std::uint32_t>(i)};
  };
  tbb::parallel_for(std::size_t{0}, keys.size(), set_key);
  tbb::parallel_sort(keys.begin(), keys.end());
  return keys;
}

class OctreeBuilder {
 public:
  OctreeBuilder(std::vector<Keyed> keys, const Lattice& lattice, std::uint32_t leaf_points)
      : keys_(std::move(keys)), leaf_points_(leaf_points) {
    tree_.lattice = lattice;
    tree_.nodes.push_back({});
  }

  Octree run() {
    split(0, 0, {}, 0, keys_.size());
    return std::move(tree_);
  }

 private:
  struct Child {
    std::uint32_t octant;
    std::size_t begin;
    std::size_t end;
  };

  // Adds the children of a node. Leaves are added first, so that their indices are consecutive.
  void split(std::uint32_t node, std::uint32_t level, Int3 cell, std::size_t begin,
             std::size_t end) {
    const std::uint32_t shift = 3U * (tree_.lattice.depth - level - 1U + core::kLeafShift - 1U);
    std::vector<Child> inner;
    std::vector<Child> leaf;
    for (std::uint32_t octant = 0; octant < 8; ++octant) {
      const std::size_t first = begin;
      while (begin < end && ((keys_[begin].key >> shift) & 7U) == octant) {
        ++begin;
      }
      if (begin > first) {
        const bool finest = level + 1 == tree_.lattice.depth;
        const bool small = leaf_points_ != 0 && begin - first <= leaf_points_;
        (finest || small ? leaf : inner).push_back({octant, first, begin});
      }
    }
    set_group(tree_.nodes[node].nodes, inner, tree_.nodes.size());
    set_group(tree_.nodes[node].leaves, leaf, tree_.leaves.size());
    const std::size_t first_child = tree_.nodes.size();
    tree_.nodes.resize(first_child + inner.size());
    for (const Child& child : leaf) {
      add_leaf(level + 1, core::child_cell(cell, child.octant), child);
    }
    for (std::size_t i = 0; i < inner.size(); ++i) {
      split(static_cast<std::uint32_t>(first_child + i), level + 1,
            core::child_cell(cell, inner[i].octant), inner[i].begin, inner[i].end);
    }
  }

  static void set_group(std::uint32_t& group, const std::vector<Child>& children,
                        std::size_t first) {
    if (children.empty()) {
      return;
    }
    group = static_cast<std::uint32_t>(first);
    for (const Child& child : children) {
      group |= 1U << (24U + child.octant);
    }
  }

  // A leaf stores ten bits per axis; a coarser leaf stores the upper bits.
  std::uint32_t word_of(std::uint64_t key, std::uint32_t level) const {
    const std::uint32_t drop = tree_.lattice.depth - level;
    const Eigen::Vector3i cell = morton_cell(key);
    const auto axis = [&](int a) { return static_cast<std::uint32_t>(cell[a]) >> drop & 1023U; };
    return axis(2) << 22 | axis(1) << 12 | axis(0) << 2;
  }

  void add_leaf(std::uint32_t level, Int3 cell, const Child& range) {
    std::vector<std::pair<std::uint32_t, std::uint32_t>> points;  // word, index
    for (std::size_t i = range.begin; i < range.end; ++i) {
      points.emplace_back(word_of(keys_[i].key, level), keys_[i].index);
    }
    std::sort(points.begin(), points.end());
    BuiltLeaf leaf;
    leaf.level = level;
    const std::int32_t edge = core::kLeafUnits << (tree_.lattice.depth - level);
    leaf.min = {tree_.lattice.root_min.x + cell.x * edge, tree_.lattice.root_min.y + cell.y * edge,
                tree_.lattice.root_min.z + cell.z * edge};
    leaf.first = static_cast<std::uint32_t>(tree_.order.size());
    for (const auto& [word, index] : points) {
      if (tree_.words.size() > leaf.first && tree_.words.back() == word) {
        ++tree_.merged;
        continue;
      }
      tree_.words.push_back(word);
      tree_.order.push_back(index);
    }
    leaf.count = static_cast<std::uint32_t>(tree_.order.size()) - leaf.first;
    tree_.leaves.push_back(leaf);
  }

  std::vector<Keyed> keys_;
  std::uint32_t leaf_points_;
  Octree tree_;
};

// Finds the cell of a level that contains the lattice coordinates, or the leaf above it.
std::uint32_t find_cell(const Octree& tree, Int3 corner, std::uint32_t level) {
  const Lattice& lattice = tree.lattice;
  const std::int32_t edge = core::kLeafUnits << lattice.depth;
  const Int3 local{corner.x - lattice.root_min.x, corner.y - lattice.root_min.y,
                   corner.z - lattice.root_min.z};
  for (const std::int32_t v : {local.x, local.y, local.z}) {
    if (v < 0 || v >= edge) {
      return core::kNeighbourNone;
    }
  }
  std::uint32_t node = 0;
  for (std::uint32_t here = 1; here <= level; ++here) {
    const std::uint32_t shift = lattice.depth - here + core::kLeafShift;
    const auto bit = [shift](std::int32_t v) {
      return (static_cast<std::uint32_t>(v) >> shift) & 1U;
    };
    const std::uint32_t octant = bit(local.x) | bit(local.y) << 1 | bit(local.z) << 2;
    const core::BlobNode& parent = tree.nodes[node];
    if ((parent.leaves >> 24 >> octant & 1U) != 0) {
      return core::child_leaf(parent, octant) | here << core::kNeighbourLevelShift;
    }
    if ((parent.nodes >> 24 >> octant & 1U) == 0) {
      return core::kNeighbourNone;
    }
    node = core::child_node(parent, octant);
  }
  return node | level << core::kNeighbourLevelShift | core::kNeighbourIsNode;
}

}  // namespace

Octree build_octree(std::span<const Eigen::Vector3d> positions,
                    std::span<const Eigen::Vector3f> normals, const Lattice& lattice,
                    std::uint32_t leaf_points) {
  return OctreeBuilder(sorted_keys(positions, normals, lattice), lattice, leaf_points).run();
}

std::vector<std::uint32_t> neighbour_table(const Octree& tree) {
  std::vector<std::uint32_t> table;
  table.reserve(6 * tree.leaves.size());
  for (const BuiltLeaf& leaf : tree.leaves) {
    const std::int32_t edge = core::kLeafUnits << (tree.lattice.depth - leaf.level);
    for (int direction = 0; direction < 6; ++direction) {
      Int3 corner = leaf.min;
      (direction < 2   ? corner.x
       : direction < 4 ? corner.y
                       : corner.z) += (direction & 1) != 0 ? edge : -edge;
      table.push_back(find_cell(tree, corner, leaf.level));
    }
  }
  return table;
}

}  // namespace tactree::builder
