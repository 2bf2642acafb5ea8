// Descents from the root to a leaf.
// Loop and memory annotations: docs/BOUND.md.

#include "tactree/core/model/octree.hpp"

#include "corner_leaves.hpp"

namespace tactree::core {
namespace {

// floor(v / step), exact. The error of the rounded quotient is less than one unit (|v| < 2^23
// steps), and step * integer is exact (blob_format.hpp), so comparisons with the integers on both
// sides correct it.
bool floor_to_lattice(float v, float step, float inverse_step, std::int32_t& units) {
  const float quotient = v * inverse_step;
  constexpr float kLimit = 2.0F * static_cast<float>(kMaxCoordinate);
  if (!(quotient > -kLimit && quotient < kLimit)) {
    return false;
  }
  units = static_cast<std::int32_t>(quotient);
  if (step * static_cast<float>(units) > v) {
    --units;
  }
  if (step * static_cast<float>(units) > v) {
    --units;
  }
  if (step * static_cast<float>(units + 1) <= v) {
    ++units;
  }
  return true;
}

constexpr std::uint32_t octant_of(std::uint32_t x, std::uint32_t y, std::uint32_t z,
                                  std::uint32_t level_below) {
  return ((x >> level_below) & 1U) | (((y >> level_below) & 1U) << 1) |
         (((z >> level_below) & 1U) << 2);
}

}  // namespace

bool descend(const BlobView& view, std::uint32_t node, std::uint32_t level, Cell cell, Leaf& leaf) {
  const Int3 root = view.root_min();
  std::uint32_t level_below = view.depth() - level;
  while (level_below > 0) {  // bound: depth
    --level_below;
    if (node >= view.node_count()) {
      return false;  // memory fault
    }
    const std::uint32_t octant = octant_of(cell.x, cell.y, cell.z, level_below);
    const BlobNode here = view.node(node, view.depth() - level_below - 1U);
    if (((here.leaves >> 24 >> octant) & 1U) != 0) {
      const auto corner = [level_below](std::uint32_t c) {
        return static_cast<std::int32_t>((c >> level_below) << (level_below + kLeafShift));
      };
      leaf = view.leaf(child_leaf(here, octant), view.depth() - level_below,
                       {root.x + corner(cell.x), root.y + corner(cell.y), root.z + corner(cell.z)});
      return true;
    }
    if (((here.nodes >> 24 >> octant) & 1U) == 0) {
      return false;
    }
    node = child_node(here, octant);
  }
  return false;
}

bool to_lattice(const BlobView& view, Vec3 position, Int3& site) {
  if (view.empty()) {
    return false;
  }
  const Int3 root = view.root_min();
  const float step = view.step_m();
  const float inverse = view.inverse_step();
  if (!floor_to_lattice(position.x, step, inverse, site.x) ||
      !floor_to_lattice(position.y, step, inverse, site.y) ||
      !floor_to_lattice(position.z, step, inverse, site.z)) {
    return false;
  }
  const std::uint32_t edge = static_cast<std::uint32_t>(kLeafUnits) << view.depth();
  return static_cast<std::uint32_t>(site.x - root.x) < edge &&
         static_cast<std::uint32_t>(site.y - root.y) < edge &&
         static_cast<std::uint32_t>(site.z - root.z) < edge;
}

bool find_leaf(const BlobView& view, Int3 site, Leaf& leaf) {
  return find_leaf_below(view, 0, 0, site, leaf);
}

bool find_leaf_below(const BlobView& view, std::uint32_t node, std::uint32_t level, Int3 site,
                     Leaf& leaf) {
  const Int3 root = view.root_min();
  return descend(view, node, level,
                 {static_cast<std::uint32_t>(site.x - root.x) >> kLeafShift,
                  static_cast<std::uint32_t>(site.y - root.y) >> kLeafShift,
                  static_cast<std::uint32_t>(site.z - root.z) >> kLeafShift},
                 leaf);
}

bool find_leaf(const BlobView& view, Vec3 position, Leaf& leaf) {
  Int3 site;
  return to_lattice(view, position, site) && find_leaf(view, site, leaf);
}

}  // namespace tactree::core
