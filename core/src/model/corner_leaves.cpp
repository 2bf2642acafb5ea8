// The cells of the cube's eight corners, and the leaves that hold them.
// Loop and memory annotations: docs/BOUND.md.
// memory: RAM

#include "corner_leaves.hpp"

namespace tactree::core {

CornerLeaves::CornerLeaves(const BlobView& view, Vec3 centre, float r)
    : view_(view), centre_(centre), below_(view.depth() - view.directory_level()) {
  is_valid_ = !view.empty() && r >= 0.0F && r <= view.reach_m() && set_axes(centre, r);
}

// Factors that shift each coordinate to its bits in a packed word. The products are exact, because
// a coordinate is below 2^10.
constexpr float kPlaceOfBits[4] = {1.0F, 1024.0F, 1048576.0F, 0.0F};

// A leaf is wider than the cube, so on each axis the cube extends beyond at most one face of the
// centre's cell. A rounded product gives the cell's number; comparison with the cell's faces
// corrects it. The faces are exact, and distances to them are rounded by far less than a lattice
// unit. The gaps are reduced by one unit to cover this; the range of reach_m in open_blob() allows
// for it.
bool CornerLeaves::set_axes(Vec3 centre, float r) {
  const float edge = view_.leaf_edge_m();
  const float step = view_.step_m();
  const auto last_cell = static_cast<std::int32_t>((1U << view_.depth()) - 1U);
  const float place[4] = {centre.x, centre.y, centre.z,
                          0.5F * edge};  // unused fourth lane: reaches no face
  const auto low_bits = static_cast<std::int32_t>((1U << below_) - 1U);
  std::uint32_t outside_axes = 0;
  for (std::uint32_t axis = 0; axis < 3; axis += kLanes) {  // bound: 3
    const auto at = load<Floats>(place + axis);
    const auto root = load<Floats>(view_.root_min_m() + axis);
    const Floats in_cells = (at - root) * view_.inverse_leaf_edge();
    if (mask_bits((in_cells > -1.0F) & (in_cells < view_.cells_and_one())) != kAllBits) {
      return false;
    }
    Integers own = to_integers(in_cells);
    Floats lower = root + edge * to_floats(own);
    Floats to_lower = at - lower;
    Floats to_upper = (lower + edge) - at;
    Floats to_face = smaller(to_upper, to_lower);
    if (mask_bits(to_face <= 0.0F) != 0) {
      own += ones_if(to_lower < 0.0F) - ones_if(to_upper <= 0.0F);
      lower = root + edge * to_floats(own);
      to_lower = at - lower;
      to_upper = (lower + edge) - at;
      to_face = smaller(to_upper, to_lower);
    }
    const Integers is_upper = ones_if(to_upper < to_lower);
    const Integers other = own - 1 - 2 * is_upper;
    const Floats local = to_lower - step;
    // Offset of the other cell: the edge for the upper one, minus the edge for the lower one.
    const Floats shift = as_floats(as_integers(all(-edge)) ^ (is_upper & INT32_MIN));
    const Floats gap = to_face - step;
    const Floats gap_or_0 = as_floats(as_integers(gap) & ones_if(gap > 0.0F));
    const auto reaches = (gap <= r) & (other >= 0) & (other <= last_cell);
    const auto outside = (own < 0) | (own > last_cell);
    axes_left_ |= mask_bits(reaches) << axis;
    outside_axes |= mask_bits(outside) << axis;
    const Floats place_of_bits = load<Floats>(kPlaceOfBits + axis);  // memory: flash
    axes_across_ |= mask_bits(((own ^ other) & ~low_bits) != 0) << axis;
    store(own, cell_[0] + axis);
    store(other, cell_[1] + axis);
    store(to_integers(to_floats(own & low_bits) * place_of_bits), packed_[0] + axis);
    store(to_integers(to_floats(other & low_bits) * place_of_bits), packed_[1] + axis);
    store(local, local_[0] + axis);
    store(local - shift, local_[1] + axis);
    store(all(0.0F), gap_squared_[0] + axis);
    store(gap_or_0 * gap_or_0, gap_squared_[1] + axis);
  }
  if (outside_axes != 0 && !reach_in(outside_axes)) {
    return false;
  }
  own_packed_ = packed_[0][0] | packed_[0][1] | packed_[0][2];
  return true;
}

// For a centre outside the root cube. Returns false if the query cube does not reach the root cube.
bool CornerLeaves::reach_in(std::uint32_t outside_axes) {
  if ((outside_axes & ~axes_left_) != 0) {
    return false;
  }
  for (std::uint32_t axis = 0; axis < 3; ++axis) {  // bound: 3
    const std::uint32_t from = outside_axes >> axis & 1U;
    cell_[0][axis] = cell_[from][axis];
    packed_[0][axis] = packed_[from][axis];
    local_[0][axis] = local_[from][axis];
  }
  axes_left_ &= ~outside_axes;
  return true;
}

std::uint32_t CornerLeaves::directory_entry(std::uint32_t corner) const {
  const std::uint32_t level = view_.directory_level();
  // memory: flash
  const std::uint32_t entry = pick(cell_, corner, 0) >> below_ |
                              pick(cell_, corner, 1) >> below_ << level |
                              pick(cell_, corner, 2) >> below_ << 2U * level;
  return view_.directory()[entry];  // memory: flash
}  // memory: flash (where the compiler places the load)

Int3 CornerLeaves::lower_corner(std::uint32_t corner) const {
  const Int3 root = view_.root_min();
  const auto units = [&](std::uint32_t axis) {
    return static_cast<std::int32_t>(pick(cell_, corner, axis) << kLeafShift);
  };
  return {root.x + units(0), root.y + units(1), root.z + units(2)};
}

// A leaf larger than the finest cell may contain several corners of the cube. It is returned for
// one of them only: the corner from which every step along one axis to the centre's side leaves it.
bool CornerLeaves::find_mixed(std::uint32_t corner, Leaf& leaf) const {
  const Cell cell{pick(cell_, corner, 0), pick(cell_, corner, 1), pick(cell_, corner, 2)};
  if (!descend(view_, 0, 0, cell, leaf)) {
    return false;
  }
  const std::uint32_t finer_levels = view_.depth() - leaf.level;
  for (std::uint32_t axis = 0; axis < 3; ++axis) {  // bound: 3
    const bool is_across = (corner >> axis & 1U) != 0;
    if (is_across && cell_[0][axis] >> finer_levels == cell_[1][axis] >> finer_levels) {
      return false;
    }
  }
  return true;
}

Int3 CornerLeaves::min_of(const NearLeaf& near) const {
  const Int3 site = lower_corner(near.corner);
  if (view_.is_uniform()) {
    return site;
  }
  Leaf leaf;
  (void)find_leaf(view_, site, leaf);  // at most: 8 * mixed per CandidateSet::gather
  return leaf.min;
}

Leaf CornerLeaves::leaf(std::uint32_t number, std::uint32_t corner) const {
  const Int3 site = lower_corner(corner);
  Leaf leaf = view_.leaf(number, view_.depth(), site);
  if (!view_.is_uniform()) {
    (void)find_leaf(view_, site, leaf);
  }
  return leaf;
}

}  // namespace tactree::core
