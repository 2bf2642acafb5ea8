#pragma once
// Point location, and the eight-corner rule.

#include <cstdint>

#include "tactree/core/blob.hpp"

namespace tactree::core {

/// Number of set bits of an octant mask (0-255).
constexpr std::uint32_t count_octants(std::uint32_t mask) {
  std::uint32_t pairs = mask - ((mask >> 1) & 0x55U);
  pairs = (pairs & 0x33U) + ((pairs >> 2) & 0x33U);
  return (pairs + (pairs >> 4)) & 0x0FU;
}

/// The lowest octant of a non-empty mask.
constexpr std::uint32_t lowest_octant(std::uint32_t mask) {
  return count_octants((mask & (~mask + 1U)) - 1U);
}

/// Index of a node's child in `octant`. Precondition: that child is an inner node (a leaf).
constexpr std::uint32_t child_node(BlobNode node, std::uint32_t octant) {
  return (node.nodes & 0xFFFFFFU) + count_octants((node.nodes >> 24) & ((1U << octant) - 1U));
}
constexpr std::uint32_t child_leaf(BlobNode node, std::uint32_t octant) {
  return (node.leaves & 0xFFFFFFU) + count_octants((node.leaves >> 24) & ((1U << octant) - 1U));
}

/// Cell of a child, in cells of its level.
constexpr Int3 child_cell(Int3 cell, std::uint32_t octant) {
  return {cell.x << 1 | static_cast<std::int32_t>(octant & 1U),
          cell.y << 1 | static_cast<std::int32_t>((octant >> 1) & 1U),
          cell.z << 1 | static_cast<std::int32_t>(octant >> 2)};
}

/// Lattice coordinates of the unit at or below `position` on each axis: floor(position / step_m),
/// exactly. False when the position is not finite or outside the root cube.
[[nodiscard]] bool to_lattice(const BlobView& view, Vec3 position, Int3& site);

/// The leaf that contains a lattice site inside the root cube. False: empty space there.
/// Cost: one descent, at most depth() levels, about 20 instructions each.
[[nodiscard]] bool find_leaf(const BlobView& view, Int3 site, Leaf& leaf);

/// The same, starting at node `node` of level `level`, whose cell holds the site.
[[nodiscard]] bool find_leaf_below(const BlobView& view, std::uint32_t node, std::uint32_t level,
                                   Int3 site, Leaf& leaf);

/// The leaf that contains a position: to_lattice() and find_leaf().
[[nodiscard]] bool find_leaf(const BlobView& view, Vec3 position, Leaf& leaf);

/// The eight-corner rule, leaf by leaf: where no leaf is smaller than the cube centre +- r, the
/// leaves that hold its eight corners are all the leaves it touches. (On each axis the cube is no
/// longer than a leaf, so a leaf that meets it contains one of its two ends.)
/// The leaf of the centre comes first, so that a search can narrow as it goes.
/// Precondition: 0 <= r <= view.reach_m(); for a larger or NaN r, or a centre that is not finite,
/// there are no leaves. Cost: at most 8 descents, which share the way to their common ancestor.
class CornerLeaves {
 public:
  CornerLeaves(const BlobView& view, Vec3 centre, float r);

  /// The next leaf whose cell is no further than the square root of `limit_squared` (m^2) from the
  /// centre; false: there is none. The limit may shrink from call to call.
  [[nodiscard]] bool next(float limit_squared, Leaf& leaf);

 private:
  struct Axis {
    std::uint32_t own = 0;    // finest cell on the centre's side, counted from the root
    std::uint32_t other = 0;  // the one beyond the nearest face, when the cube reaches into it
    bool reaches_other = false;
    float squared_to_other = 0.0F;  // m^2, not rounded up
  };

  bool set_axis(std::uint32_t axis, float centre, float r);
  bool find_common_node();
  bool is_repeated(std::uint32_t number);

  const BlobView* view_;
  Axis axes_[3];
  std::uint32_t node_ = 0;  // deepest node that holds all eight corners
  std::uint32_t level_ = 0;
  std::uint32_t corners_left_ = 0;  // bit = which axes take the other cell
  float away_squared_[kLeavesPerQuery] = {};
  std::uint32_t seen_[kLeavesPerQuery] = {};
  std::uint32_t seen_count_ = 0;
};

/// All leaves that CornerLeaves finds within r.
struct LeafSet {
  Leaf leaves[kLeavesPerQuery];
  std::uint32_t count = 0;
};
void find_leaves_within(const BlobView& view, Vec3 centre, float r, LeafSet& found);

}  // namespace tactree::core
