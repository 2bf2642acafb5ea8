#pragma once
// Point location in the octree of a blob.
//
// Interrupt safety: pure functions.
// Loop and memory annotations: docs/BOUND.md.

#include <cstdint>

#include "tactree/core/model/blob.hpp"

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

/// Table of count_octants() for masks without the highest octant (0-127). A table, because every
/// step of a descent has to wait for this count.
struct OctantCounts {
  std::uint8_t of[128];
};
inline constexpr OctantCounts kOctantCounts = [] {
  OctantCounts counts{};
  for (std::uint32_t mask = 0; mask < 128; ++mask) {  // bound: 128
    counts.of[mask] = static_cast<std::uint8_t>(count_octants(mask));
  }
  return counts;
}();
constexpr std::uint32_t count_low_octants(std::uint32_t mask) {
  return kOctantCounts.of[mask];  // memory: flash
}

/// Index of the child in `octant`, from a group word of a node. Precondition: the child exists.
constexpr std::uint32_t child_of(std::uint32_t group, std::uint32_t octant) {
  return (group & 0xFFFFFFU) + count_low_octants((group >> 24) & ((1U << octant) - 1U));
}
constexpr std::uint32_t child_node(BlobNode node, std::uint32_t octant) {
  return child_of(node.nodes, octant);
}
constexpr std::uint32_t child_leaf(BlobNode node, std::uint32_t octant) {
  return child_of(node.leaves, octant);
}

/// Coordinates of a child's cell, in cells of the child's level.
constexpr Int3 child_cell(Int3 cell, std::uint32_t octant) {
  return {cell.x << 1 | static_cast<std::int32_t>(octant & 1U),
          cell.y << 1 | static_cast<std::int32_t>((octant >> 1) & 1U),
          cell.z << 1 | static_cast<std::int32_t>(octant >> 2)};
}

/// Lattice coordinates of `position` (m): floor(position / step_m) on each axis, exact.
/// Returns false if the position is not finite or outside the root cube.
[[nodiscard]] bool to_lattice(const BlobView& view, Vec3 position, Int3& site);

/// Finds the leaf that contains a lattice site inside the root cube. Returns false in empty space.
/// Cost: one descent, at most depth() levels, about 20 instructions each.
[[nodiscard]] bool find_leaf(const BlobView& view, Int3 site, Leaf& leaf);

/// As above, but starts at node `node` of level `level`. Precondition: the node's cell contains the
/// site.
[[nodiscard]] bool find_leaf_below(const BlobView& view, std::uint32_t node, std::uint32_t level,
                                   Int3 site, Leaf& leaf);

/// Finds the leaf that contains a position: to_lattice(), then find_leaf().
[[nodiscard]] bool find_leaf(const BlobView& view, Vec3 position, Leaf& leaf);

}  // namespace tactree::core
