#include "tactree/core/octree.hpp"

namespace tactree::core {
namespace {

// floor(v / step) as an exact integer. The quotient by multiplication is off by less than one
// unit (|v| < 2^23 steps), and step * integer is exact by the blob's contract, so one comparison
// on each side settles it.
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

// A cell of the finest level, counted from the root's lower corner.
struct Cell {
  std::uint32_t x;
  std::uint32_t y;
  std::uint32_t z;
};

bool descend(const BlobView& view, std::uint32_t node, std::uint32_t level, Cell cell, Leaf& leaf) {
  const BlobNode* const nodes = view.nodes();
  const Int3 root{view.header().root_min[0], view.header().root_min[1], view.header().root_min[2]};
  std::uint32_t level_below = view.depth() - level;
  while (level_below > 0) {  // bound: depth
    --level_below;
    const std::uint32_t octant = octant_of(cell.x, cell.y, cell.z, level_below);
    const BlobNode here = nodes[node];
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

}  // namespace

bool to_lattice(const BlobView& view, Vec3 position, Int3& site) {
  if (view.empty()) {
    return false;
  }
  const BlobHeader& header = view.header();
  const float step = view.step_m();
  const float inverse = view.inverse_step();
  if (!floor_to_lattice(position.x, step, inverse, site.x) ||
      !floor_to_lattice(position.y, step, inverse, site.y) ||
      !floor_to_lattice(position.z, step, inverse, site.z)) {
    return false;
  }
  const std::uint32_t edge = static_cast<std::uint32_t>(kLeafUnits) << view.depth();
  return static_cast<std::uint32_t>(site.x - header.root_min[0]) < edge &&
         static_cast<std::uint32_t>(site.y - header.root_min[1]) < edge &&
         static_cast<std::uint32_t>(site.z - header.root_min[2]) < edge;
}

bool find_leaf(const BlobView& view, Int3 site, Leaf& leaf) {
  return find_leaf_below(view, 0, 0, site, leaf);
}

bool find_leaf_below(const BlobView& view, std::uint32_t node, std::uint32_t level, Int3 site,
                     Leaf& leaf) {
  const BlobHeader& header = view.header();
  return descend(view, node, level,
                 {static_cast<std::uint32_t>(site.x - header.root_min[0]) >> kLeafShift,
                  static_cast<std::uint32_t>(site.y - header.root_min[1]) >> kLeafShift,
                  static_cast<std::uint32_t>(site.z - header.root_min[2]) >> kLeafShift},
                 leaf);
}

bool find_leaf(const BlobView& view, Vec3 position, Leaf& leaf) {
  Int3 site;
  return to_lattice(view, position, site) && find_leaf(view, site, leaf);
}

CornerLeaves::CornerLeaves(const BlobView& view, Vec3 centre, float r) : view_(&view) {
  if (view.empty() || !(r >= 0.0F && r <= view.reach_m())) {
    return;
  }
  if (!set_axis(0, centre.x, r) || !set_axis(1, centre.y, r) || !set_axis(2, centre.z, r) ||
      !find_common_node()) {
    return;
  }
  corners_left_ = 1;
  for (std::uint32_t axis = 0; axis < 3; ++axis) {  // bound: 3
    const std::uint32_t across = 1U << axis;
    for (std::uint32_t corner = 0; corner < across; ++corner) {  // bound: 4
      away_squared_[corner | across] = away_squared_[corner] + axes_[axis].squared_to_other;
    }
    if (axes_[axis].reaches_other) {
      corners_left_ |= corners_left_ << across;
    }
  }
}

// A leaf is wider than the cube, so the cube reaches beyond one face of the centre's cell at most.
// Distances to the faces are rounded, by far less than a lattice unit: hence one unit more, for
// which open_blob() has checked that there is room.
bool CornerLeaves::set_axis(std::uint32_t axis, float centre, float r) {
  const float step = view_->step_m();
  std::int32_t units;
  if (!floor_to_lattice(centre, step, view_->inverse_step(), units)) {
    return false;
  }
  const std::int32_t root = view_->header().root_min[axis];
  const std::int32_t cells = 1 << view_->depth();
  const std::int32_t own = (units - root) >> kLeafShift;
  const float to_lower = centre - step * static_cast<float>(root + (own << kLeafShift));
  const float to_upper = step * static_cast<float>(root + ((own + 1) << kLeafShift)) - centre;
  const bool upper = to_upper < to_lower;
  const float away = upper ? to_upper : to_lower;
  const std::int32_t other = upper ? own + 1 : own - 1;
  const bool reaches = away <= r + step && other >= 0 && other < cells;
  Axis& result = axes_[axis];
  if (own >= 0 && own < cells) {
    result = {static_cast<std::uint32_t>(own), static_cast<std::uint32_t>(other), reaches,
              0.999999F * (away * away)};
    return true;
  }
  // The centre is outside the root, but the cube may reach in.
  result = {static_cast<std::uint32_t>(other), 0, false, 0.0F};
  return reaches;
}

// Walks down as long as all corners take the same way. False: that way leads into empty space.
bool CornerLeaves::find_common_node() {
  std::uint32_t differing = 0;
  for (const Axis& axis : axes_) {  // bound: 3
    differing |= axis.reaches_other ? axis.own ^ axis.other : 0U;
  }
  std::uint32_t level_below = view_->depth();
  while (level_below > 1 && differing >> (level_below - 1U) == 0) {  // bound: depth
    const BlobNode here = view_->nodes()[node_];
    const std::uint32_t octant =
        octant_of(axes_[0].own, axes_[1].own, axes_[2].own, level_below - 1U);
    if (((here.leaves >> 24 >> octant) & 1U) != 0) {
      break;
    }
    if (((here.nodes >> 24 >> octant) & 1U) == 0) {
      return false;
    }
    node_ = child_node(here, octant);
    --level_below;
  }
  level_ = view_->depth() - level_below;
  return true;
}

// A leaf larger than the finest may hold several corners.
bool CornerLeaves::is_repeated(std::uint32_t number) {
  for (std::uint32_t i = 0; i < seen_count_; ++i) {  // bound: 8
    if (seen_[i] == number) {
      return true;
    }
  }
  seen_[seen_count_++] = number;
  return false;
}

bool CornerLeaves::next(float limit_squared, Leaf& leaf) {
  while (corners_left_ != 0) {  // bound: 8
    const std::uint32_t corner = lowest_octant(corners_left_);
    corners_left_ &= corners_left_ - 1U;
    if (away_squared_[corner] > limit_squared) {
      continue;
    }
    const auto cell = [this, corner](std::uint32_t axis) {
      return ((corner >> axis) & 1U) != 0 ? axes_[axis].other : axes_[axis].own;
    };
    if (descend(*view_, node_, level_, {cell(0), cell(1), cell(2)}, leaf) &&
        !is_repeated(leaf.number)) {
      return true;
    }
  }
  return false;
}

void find_leaves_within(const BlobView& view, Vec3 centre, float r, LeafSet& found) {
  CornerLeaves leaves(view, centre, r);
  found.count = 0;
  const float everything = 4.0F * view.reach_m() * view.reach_m();
  while (found.count < kLeavesPerQuery &&
         leaves.next(everything, found.leaves[found.count])) {  // bound: 8
    ++found.count;
  }
}

}  // namespace tactree::core
