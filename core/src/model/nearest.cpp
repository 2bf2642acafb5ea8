// Exact neighbour queries over the leaves of the eight-corner rule.
// Loop and memory annotations: docs/BOUND.md.

#include "tactree/core/model/nearest.hpp"

#include <bit>

#include "leaf_scan.hpp"

namespace tactree::core {

namespace {

constexpr std::int32_t kNone = 0x7FFFFFFF;  // above the index of any point

struct Nearest {
  float squared;
  std::int32_t index;
};

struct NearestOfLanes {
  Floats squared;
  Integers index;
};

float next_above(float positive) {
  return std::bit_cast<float>(std::bit_cast<std::uint32_t>(positive) + 1U);
}

// Returns true if a point of the leaf replaces `best`. A lane keeps the first of equally near
// points, which has the lowest index. The lanes start just above best.squared, so that a point as
// near as `best` is found, and replaces it if its index is lower.
bool nearest_in_leaf(const LeafScan& scan, Nearest& best) {
  NearestOfLanes lanes{all(next_above(best.squared)), all(kNone)};
  scan.each_block([&lanes](Floats squared, Integers index) {
    lanes.index = select(squared < lanes.squared, index, lanes.index);
    lanes.squared = smaller(squared, lanes.squared);
  });
  const float squared = smallest(lanes.squared);
  if (squared > best.squared) {
    return false;
  }
  const std::int32_t index = smallest(select(lanes.squared == squared, lanes.index, all(kNone)));
  if (squared == best.squared && index > best.index) {
    return false;
  }
  best = {squared, index};
  return true;
}

}  // namespace

NearestPoint nearest_within(const BlobView& view, Vec3 probe, float r) {
  CornerLeaves corners(view, probe, r);
  Nearest best{r * r, kNone};
  std::uint32_t number = 0;
  std::uint32_t corner = 0;
  corners.each(best.squared, [&](const NearLeaf& leaf) {
    if (nearest_in_leaf(LeafScan(view, leaf), best)) {
      number = leaf.number;
      corner = leaf.corner;
    }
    return best.squared;
  });
  if (best.index == kNone) {
    return {};
  }
  const auto index = static_cast<std::uint32_t>(best.index);
  return {index, best.squared, view.position(corners.leaf(number, corner), index), number};
}

bool in_any_vertex_box(const BlobView& view, Vec3 probe) {
  if (view.empty()) {
    return false;
  }
  const float half = 0.5F * view.header().aabb_edge_m;
  // Above the squared distance of a box's corner, 3 half^2, so that no leaf is skipped.
  const float everything = 4.0F * half * half;
  bool found = false;
  CornerLeaves(view, probe, half).each(everything, [&](const NearLeaf& leaf) {
    found = leaf_has_box_around(view, leaf, half);
    return found ? -1.0F : everything;
  });
  return found;
}

}  // namespace tactree::core
