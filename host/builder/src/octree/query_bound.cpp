#include "octree/query_bound.hpp"

#include <algorithm>
#include <cstddef>
#include <unordered_map>
#include <utility>
#include <vector>

namespace tactree::builder {
namespace {

QueryBound of_fullest_leaves(const Octree& tree) {
  std::vector<std::uint32_t> counts;
  for (const BuiltLeaf& leaf : tree.leaves) {
    counts.push_back(leaf.count);
  }
  std::sort(counts.rbegin(), counts.rend());
  counts.resize(std::min<std::size_t>(counts.size(), core::kLeavesPerQuery));
  std::uint32_t sum = 0;
  for (const std::uint32_t count : counts) {
    sum += count;
  }
  return {sum, sum};
}

/// Leaves of one size, indexed by their cells.
class Blocks {
 public:
  explicit Blocks(const Octree& tree) : tree_(tree) {
    for (const BuiltLeaf& leaf : tree.leaves) {
      const std::uint64_t key = key_of(leaf);
      leaves_.emplace(key, &leaf);
      for (std::uint64_t corner = 0; corner < 8; ++corner) {
        counts_[key + offset_of(corner)] += leaf.count;
      }
    }
  }

  QueryBound bound(double reach_m) const {
    std::vector<std::pair<std::uint32_t, std::uint64_t>> fullest;
    for (const auto& [key, count] : counts_) {
      fullest.emplace_back(count, key);
    }
    std::sort(fullest.rbegin(), fullest.rend());
    QueryBound bound{fullest.empty() ? 0U : fullest.front().first, 0};
    for (const auto& [count, key] : fullest) {
      if (count <= bound.points_per_slab) {
        break;  // a slab cannot hold more points than its block
      }
      bound.points_per_slab = std::max(bound.points_per_slab, fullest_slab(key, reach_m));
    }
    return bound;
  }

 private:
  static constexpr std::uint32_t kAxisBits = 20;

  // The key of a block is that of its upper cell.
  static std::uint64_t offset_of(std::uint64_t corner) {
    return (corner & 1U) | (corner >> 1 & 1U) << kAxisBits | (corner >> 2) << 2 * kAxisBits;
  }
  std::uint64_t key_of(const BuiltLeaf& leaf) const {
    const auto cell = [](std::int32_t v, std::int32_t root) {
      return static_cast<std::uint64_t>((v - root) / core::kLeafUnits);
    };
    const core::Int3 root = tree_.lattice.root_min;
    return cell(leaf.min.x, root.x) | cell(leaf.min.y, root.y) << kAxisBits |
           cell(leaf.min.z, root.z) << 2 * kAxisBits;
  }

  std::uint32_t fullest_slab(std::uint64_t key, double reach_m) const {
    std::vector<std::int32_t> heights;  // lattice units
    for (std::uint64_t corner = 0; corner < 8; ++corner) {
      const auto found = leaves_.find(key - offset_of(corner));
      if (found != leaves_.end()) {
        add_heights(*found->second, heights);
      }
    }
    std::sort(heights.begin(), heights.end());
    const double thickness = 2.0 * reach_m / tree_.lattice.step_m;
    std::size_t most = 0;
    std::size_t first = 0;
    for (std::size_t last = 0; last < heights.size(); ++last) {
      while (heights[last] - heights[first] > thickness) {
        ++first;
      }
      most = std::max(most, last - first + 1);
    }
    return static_cast<std::uint32_t>(most);
  }

  void add_heights(const BuiltLeaf& leaf, std::vector<std::int32_t>& heights) const {
    for (std::uint32_t i = 0; i < leaf.count; ++i) {
      const std::uint32_t site = tree_.words[leaf.first + i] >> 22;
      heights.push_back(leaf.min.z + static_cast<std::int32_t>(2U * site));
    }
  }

  const Octree& tree_;
  std::unordered_map<std::uint64_t, const BuiltLeaf*> leaves_;
  std::unordered_map<std::uint64_t, std::uint32_t> counts_;
};

}  // namespace

QueryBound query_bound(const Octree& tree, core::Profile profile, double reach_m) {
  return profile == core::Profile::kPaper ? of_fullest_leaves(tree) : Blocks(tree).bound(reach_m);
}

}  // namespace tactree::builder
