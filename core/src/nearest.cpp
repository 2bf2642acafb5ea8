#include "tactree/core/nearest.hpp"

#include "leaf_scan.hpp"
#include "tactree/core/octree.hpp"

namespace tactree::core {

namespace {

void keep_nearer(float squared, std::uint32_t index, NearestPoint& best) {
  if (squared < best.distance_squared || (squared == best.distance_squared && index < best.index)) {
    best.distance_squared = squared;
    best.index = index;
  }
}

float smallest(const float (&v)[LeafScan::kLanes]) {
  float half[LeafScan::kLanes / 2];
  for (std::uint32_t k = 0; k < LeafScan::kLanes / 2; ++k) {  // bound: 4
    half[k] = v[k] < v[k + 4] ? v[k] : v[k + 4];
  }
  const float left = half[0] < half[2] ? half[0] : half[2];
  const float right = half[1] < half[3] ? half[1] : half[3];
  return left < right ? left : right;
}

// True when a point of the leaf became the best. Eight at a time; the last eight may overlap the
// ones before, which changes nothing.
bool nearest_in_leaf(const Leaf& leaf, const LeafScan& scan, NearestPoint& best) {
  constexpr std::uint32_t kLanes = LeafScan::kLanes;
  const std::uint32_t before = best.index;
  const std::uint32_t end = leaf.first_point + leaf.point_count;
  if (leaf.point_count < kLanes) {
    for (std::uint32_t p = leaf.first_point; p < end; ++p) {  // bound: 8
      keep_nearer(length_squared(scan.offset(p)), p, best);
    }
    return best.index != before;
  }
  for (std::uint32_t p = leaf.first_point; p < end;
       p += kLanes) {  // bound: points_per_leaf / 8 + 1
    const std::uint32_t first = p < end - kLanes ? p : end - kLanes;
    float squared[kLanes];
    scan.distances_squared(first, squared);
    if (smallest(squared) > best.distance_squared) {
      continue;
    }
    for (std::uint32_t k = 0; k < kLanes; ++k) {  // bound: 8
      keep_nearer(squared[k], first + k, best);
    }
  }
  return best.index != before;
}

}  // namespace

NearestPoint nearest_within(const BlobView& view, Vec3 probe, float r) {
  CornerLeaves leaves(view, probe, r);
  NearestPoint best;
  best.distance_squared = r * r;
  Leaf leaf;
  Leaf best_leaf;
  while (leaves.next(best.distance_squared, leaf)) {  // bound: 8
    if (nearest_in_leaf(leaf, LeafScan(view, leaf, probe), best)) {
      best_leaf = leaf;
    }
  }
  if (best.found()) {
    best.position = view.position(best_leaf, best.index);
    best.leaf = best_leaf.number;
  } else {
    best.distance_squared = 0.0F;
  }
  return best;
}

PointsWithin points_within(const BlobView& view, Vec3 probe, float r,
                           std::span<std::uint32_t> out) {
  CornerLeaves leaves(view, probe, r);
  PointsWithin result;
  const float limit = r * r;
  Leaf leaf;
  while (leaves.next(limit, leaf)) {  // bound: 8
    const LeafScan scan(view, leaf, probe);
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
  CornerLeaves leaves(view, probe, half);
  Leaf leaf;
  while (leaves.next(4.0F * half * half, leaf)) {  // bound: 8
    if (leaf_has_box_around(view, leaf, probe, half)) {
      return true;
    }
  }
  return false;
}

}  // namespace tactree::core
