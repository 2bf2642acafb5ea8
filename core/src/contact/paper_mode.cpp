// The six-point rule, over the neighbour table or from the root.
// Loop and memory annotations: docs/BOUND.md.

#include "tactree/core/contact/paper_mode.hpp"

#include "model/leaf_scan.hpp"
#include "tactree/core/model/octree.hpp"

namespace tactree::core {
namespace {

// The probe, displaced by s along direction 0-5: -x +x -y +y -z +z.
Vec3 six_point(Vec3 probe, float s, std::uint32_t direction) {
  const float shift = (direction & 1U) != 0 ? s : -s;
  Vec3 moved = probe;
  if (direction < 2) {
    moved.x += shift;
  } else if (direction < 4) {
    moved.y += shift;
  } else {
    moved.z += shift;
  }
  return moved;
}

bool contains(const BlobView& view, const Leaf& leaf, Int3 site) {
  const auto edge = static_cast<std::uint32_t>(kLeafUnits) << (view.depth() - leaf.level);
  return static_cast<std::uint32_t>(site.x - leaf.min.x) < edge &&
         static_cast<std::uint32_t>(site.y - leaf.min.y) < edge &&
         static_cast<std::uint32_t>(site.z - leaf.min.z) < edge;
}

// Lower corner, on one axis, of the cell that holds `site`; the cell's edge is 2^shift units.
std::int32_t cell_corner(std::int32_t site, std::int32_t root, std::uint32_t shift) {
  return root + (((site - root) >> shift) << shift);
}

// Finds the leaf that holds `site`: through the neighbour table of `from` if the site is in the
// adjacent cell, otherwise (s longer than the leaf, or the probe outside it) from the root. Both
// ways give the same result.
bool find_neighbour(const BlobView& view, const Leaf& from, std::uint32_t direction, Int3 site,
                    Leaf& found) {
  const std::uint32_t shift = view.depth() - from.level + kLeafShift;
  Int3 next_to = from.min;
  const std::int32_t edge = (direction & 1U) != 0 ? 1 << shift : -(1 << shift);
  (direction < 2 ? next_to.x : direction < 4 ? next_to.y : next_to.z) += edge;
  const Int3 root = view.root_min();
  const auto corner_at = [&](std::uint32_t s) {
    return Int3{cell_corner(site.x, root.x, s), cell_corner(site.y, root.y, s),
                cell_corner(site.z, root.z, s)};
  };
  if (!view.has_neighbours() || !(corner_at(shift) == next_to)) {
    return find_leaf(view, site, found);
  }
  const std::uint32_t entry = view.neighbours(from.number)[direction];
  const std::uint32_t index = entry & kNeighbourIndexMask;
  const std::uint32_t level = (entry & ~kNeighbourIsNode) >> kNeighbourLevelShift;
  if (entry == kNeighbourNone || level > view.depth()) {  // the latter after a memory fault
    return false;
  }
  if ((entry & kNeighbourIsNode) != 0) {
    return find_leaf_below(view, index, level, site, found);
  }
  found = view.leaf(index, level, corner_at(view.depth() - level + kLeafShift));
  return true;
}

// Keeps the nearest of a leaf's points; ties go to the lower index.
void nearest_in_leaf(const BlobView& view, const Leaf& leaf, Vec3 probe, NearestPoint& best) {
  const LeafScan scan(view, near_leaf(view, leaf, probe));
  const std::uint32_t end = leaf.first_point + leaf.point_count;
  for (std::uint32_t p = leaf.first_point; p < end; ++p) {  // bound: points_per_leaf_max
    const float squared = length_squared(scan.offset(p));
    if (!best.found() || squared < best.distance_squared ||
        (squared == best.distance_squared && p < best.index)) {
      best = {p, squared, view.position(leaf, p), leaf.number};
    }
  }
}

}  // namespace

PaperContact paper_collision(const BlobView& view, Vec3 probe) {
  PaperContact contact;
  if (view.empty() || !is_finite(probe)) {
    return contact;
  }
  const float half = 0.5F * view.header().aabb_edge_m;
  if (find_leaf(view, probe, contact.leaf) &&
      leaf_has_box_around(view, near_leaf(view, contact.leaf, probe), half)) {
    contact.in_contact = true;
    return contact;
  }
  for (std::uint32_t direction = 0; direction < 6; ++direction) {  // bound: 6
    const Vec3 moved = six_point(probe, view.header().six_point_offset_m, direction);
    if (find_leaf(view, moved, contact.leaf) &&
        leaf_has_box_around(view, near_leaf(view, contact.leaf, probe), half)) {
      contact.in_contact = true;
      return contact;
    }
  }
  return contact;
}

NearestPoint paper_nearest(const BlobView& view, Vec3 probe, const PaperContact& contact) {
  NearestPoint best;
  if (view.empty() || !contact.in_contact || !is_finite(probe)) {
    return best;
  }
  nearest_in_leaf(view, contact.leaf, probe, best);
  for (std::uint32_t direction = 0; direction < 6; ++direction) {  // bound: 6
    const Vec3 moved = six_point(probe, view.header().six_point_offset_m, direction);
    Int3 site;
    Leaf leaf;
    if (!to_lattice(view, moved, site) || contains(view, contact.leaf, site)) {
      continue;
    }
    if (find_neighbour(view, contact.leaf, direction, site, leaf)) {
      nearest_in_leaf(view, leaf, probe, best);
    }
  }
  return best;
}

}  // namespace tactree::core
