#pragma once
// The leaves that a cube touches, by the eight-corner rule, in a set. For tests of that rule.

#include "model/corner_leaves.hpp"

namespace tactree::test {

struct LeafSet {
  core::Leaf leaves[core::kLeavesPerQuery];
  std::uint32_t count = 0;
};

inline LeafSet leaves_within(const core::BlobView& view, core::Vec3 centre, float r) {
  LeafSet found;
  core::CornerLeaves corners(view, centre, r);
  const float everything = 4.0F * view.reach_m() * view.reach_m();
  corners.each(everything, [&](const core::NearLeaf& leaf) {
    found.leaves[found.count++] = corners.leaf(leaf.number, leaf.corner);
    return everything;
  });
  return found;
}

}  // namespace tactree::test
