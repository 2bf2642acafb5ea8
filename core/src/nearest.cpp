#include "tactree/core/nearest.hpp"

#include "leaf_scan.hpp"
#include "tactree/core/octree.hpp"

namespace tactree::core {

NearestPoint nearest_within(const BlobView& view, Vec3 probe, float r) {
  LeafSet set;
  find_leaves_within(view, probe, r, set);
  NearestPoint best;
  best.distance_squared = r * r;
  std::uint32_t best_leaf = 0;
  for (std::uint32_t i = 0; i < set.count; ++i) {  // bound: 8
    const Leaf& leaf = set.leaves[i];
    const LeafScan scan(view, leaf, probe);
    if (scan.distance_squared_to_cube() > best.distance_squared) {
      continue;
    }
    const std::uint32_t end = leaf.first_point + leaf.point_count;
    for (std::uint32_t p = leaf.first_point; p < end; ++p) {  // bound: points_per_leaf
      const float squared = length_squared(scan.offset(p));
      if (squared < best.distance_squared || (squared == best.distance_squared && p < best.index)) {
        best.distance_squared = squared;
        best.index = p;
        best_leaf = i;
      }
    }
  }
  if (best.found()) {
    best.position = view.position(set.leaves[best_leaf], best.index);
    best.leaf = set.leaves[best_leaf].number;
  } else {
    best.distance_squared = 0.0F;
  }
  return best;
}

PointsWithin points_within(const BlobView& view, Vec3 probe, float r,
                           std::span<std::uint32_t> out) {
  LeafSet set;
  find_leaves_within(view, probe, r, set);
  PointsWithin result;
  const float limit = r * r;
  for (std::uint32_t i = 0; i < set.count; ++i) {  // bound: 8
    const Leaf& leaf = set.leaves[i];
    const LeafScan scan(view, leaf, probe);
    if (scan.distance_squared_to_cube() > limit) {
      continue;
    }
    const std::uint32_t end = leaf.first_point + leaf.point_count;
    for (std::uint32_t p = leaf.first_point; p < end; ++p) {  // bound: points_per_leaf
      if (length_squared(scan.offset(p)) > limit) {
        continue;
      }
      if (result.count == out.size()) {
        result.complete = false;
        return result;
      }
      out[result.count++] = p;
    }
  }
  return result;
}

bool in_any_vertex_box(const BlobView& view, Vec3 probe) {
  if (view.empty()) {
    return false;
  }
  const float half = 0.5F * view.header().aabb_edge_m;
  LeafSet set;
  find_leaves_within(view, probe, half, set);
  for (std::uint32_t i = 0; i < set.count; ++i) {  // bound: 8
    const Leaf& leaf = set.leaves[i];
    if (leaf_has_box_around(view, leaf, probe, half)) {
      return true;
    }
  }
  return false;
}

}  // namespace tactree::core
