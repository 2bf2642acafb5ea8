// Loop and memory annotations: docs/BOUND.md.

#include "tactree/core/model/interior.hpp"

#include "tactree/core/model/octree.hpp"

namespace tactree::core {
namespace {

/// A position in lattice units from the lower corner of the root cube.
struct Units {
  std::uint32_t x, y, z;

  /// Octant that contains the position in its cell of edge 2^(shift + 1).
  [[nodiscard]] std::uint32_t octant(std::uint32_t shift) const {
    return ((x >> shift) & 1U) | (((y >> shift) & 1U) << 1) | (((z >> shift) & 1U) << 2);
  }
};

bool marks(std::uint8_t octants, std::uint32_t octant) { return (octants >> octant & 1U) != 0U; }

}  // namespace

Interior interior_at(const BlobView& view, Vec3 position) {
  Int3 site;
  if (!to_lattice(view, position, site) || view.interior() == nullptr) {
    return {};
  }
  const Int3 root = view.root_min();
  const Units at{static_cast<std::uint32_t>(site.x - root.x),
                 static_cast<std::uint32_t>(site.y - root.y),
                 static_cast<std::uint32_t>(site.z - root.z)};
  const std::uint8_t* const of_nodes = view.interior();
  const std::uint8_t* const of_leaves = of_nodes + view.node_count();
  std::uint32_t node = 0;
  for (std::uint32_t level = 0; level < view.depth(); ++level) {  // bound: depth
    if (node >= view.node_count()) {
      return {};  // memory fault
    }
    const std::uint32_t shift = kLeafShift + view.depth() - level - 1U;
    const std::uint32_t octant = at.octant(shift);
    const bool marked = marks(of_nodes[node], octant);  // memory: flash
    const BlobNode here = view.node(node, level);
    if ((here.leaves >> 24 >> octant & 1U) != 0U) {
      const std::uint32_t leaf = child_leaf(here, octant);
      const bool eighth = leaf < view.leaf_count() &&
                          marks(of_leaves[leaf], at.octant(shift - 1U));  // memory: flash
      return {eighth, marked};
    }
    if ((here.nodes >> 24 >> octant & 1U) == 0U) {
      return {marked, false};
    }
    node = child_node(here, octant);
  }
  return {};
}

}  // namespace tactree::core
