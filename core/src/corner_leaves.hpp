#pragma once
// The eight-corner rule: where no leaf is smaller than the cube centre +- r, the leaves that hold
// its eight corners are all the leaves it touches. (On each axis the cube is no longer than a leaf,
// so a leaf that meets it contains one of its two ends.)

#include "tactree/core/octree.hpp"

namespace tactree::core {

/// A leaf near a place, as a search through its points needs it.
struct NearLeaf {
  std::uint32_t number = 0;
  std::uint32_t first_point = 0;
  std::uint32_t end_point = 0;  ///< one behind its last
  std::uint32_t corner = 0;     ///< which of the eight it is of
  float site_m = 0.0F;          ///< length of a site
  Vec3 local{};                 ///< of the place, m, counted from the leaf's first site
};

/// A leaf as seen from a place; its corner is 0.
[[nodiscard]] NearLeaf near_leaf(const BlobView& view, const Leaf& leaf, Vec3 place);

/// Those leaves one by one, the centre's first, so that a search can narrow as it goes.
/// Precondition: 0 <= r <= view.reach_m(); for a larger or NaN r, or a centre that is not finite,
/// there are no leaves. Cost: at most 8 descents of at most depth() levels, about 20 instructions
/// each; what they share with the centre's, and levels above the directory, are not walked again.
class CornerLeaves {
 public:
  CornerLeaves(const BlobView& view, Vec3 centre, float r);

  /// The next leaf whose cell is no further than the square root of `limit_squared` (m^2) from the
  /// centre, or by less than two lattice units; false: there is none. The limit may shrink from
  /// call to call.
  [[nodiscard]] bool next(float limit_squared, NearLeaf& leaf);
  /// The same, compiled into the caller.
  [[nodiscard, gnu::always_inline]] inline bool next_inlined(float limit_squared, NearLeaf& leaf);

  /// The whole of a leaf that next() found.
  [[nodiscard]] Leaf leaf(std::uint32_t number, std::uint32_t corner) const;

 private:
  bool set_axes(Vec3 centre, float r);
  bool reach_in(std::uint32_t outside_axes);
  [[nodiscard]] std::uint32_t directory_entry(std::uint32_t corner) const;
  [[nodiscard]] std::uint32_t find_own();
  [[nodiscard]] std::uint32_t find_other(std::uint32_t corner) const;
  [[nodiscard]] Int3 lower_corner(std::uint32_t corner) const;
  [[nodiscard]] bool find_mixed(std::uint32_t corner, NearLeaf& leaf);
  [[nodiscard]] bool next_mixed(float limit_squared, NearLeaf& leaf);
  void describe(std::uint32_t number, NearLeaf& leaf) const;
  void drop_axes(float limit_squared);
  [[nodiscard]] bool is_beyond(std::uint32_t corner, float limit_squared) const;

  template <typename T>
  [[nodiscard]] static T pick(const T (&of)[2][4], std::uint32_t corner, std::uint32_t axis) {
    return of[corner >> axis & 1U][axis];
  }

  const BlobView& view_;
  Vec3 centre_;
  // On each axis the centre's finest cell, and the one beyond its nearest face:
  std::uint32_t cell_[2][4];  // counted from the root
  float local_[2][4];         // of the centre, m, counted from the cell's first site
  float gap_squared_[2][4];   // m^2 from the centre to the cell, rounded down
  std::uint32_t below_;            // levels between the directory and the leaves
  std::uint32_t axes_left_ = 0;    // bit = an axis whose other cell is in reach
  std::uint32_t corner_ = kBegin;  // visited last; bit = an axis on which it takes the other cell
  // The centre's descent, by levels below: the nodes, then the leaf's number.
  std::uint32_t path_[kMaxLevelsBelow + 1];
  std::uint32_t path_end_ = 0;  // where it ends: 0 is the leaf
  std::uint32_t seen_count_ = 0;
  std::uint32_t seen_[kLeavesPerQuery];

  static constexpr std::uint32_t kBegin = 8;
};

// With the low bits of a cell's three coordinates side by side in one word, ten each, an octant is
// one product away: the factor brings the bits 0, 10 and 20 together at the top.
static_assert(kMaxLevelsBelow <= 10);
constexpr std::uint32_t pack(std::uint32_t x, std::uint32_t y, std::uint32_t z,
                             std::uint32_t bits) {
  const std::uint32_t low = (1U << bits) - 1U;
  return (x & low) | (y & low) << 10 | (z & low) << 20;
}
constexpr std::uint32_t octant_of(std::uint32_t packed, std::uint32_t level_below) {
  return ((packed >> level_below) & 0x00100401U) * 0x20100800U >> 29;
}
static_assert(octant_of(pack(0, 4, 0, 3), 2) == 2 && octant_of(pack(7, 3, 12, 3), 2) == 5);

// The child of a node whose children are all of one kind; kNoNode: there is none.
inline std::uint32_t step_down(const BlobView& view, std::uint32_t node, std::uint32_t octant) {
  const std::uint32_t group = view.node_words()[node];
  const std::uint32_t mask = group >> 24;
  const std::uint32_t bit = 1U << octant;
  return (mask & bit) != 0 ? (group & 0xFFFFFFU) + count_low_octants(mask & (bit - 1U)) : kNoNode;
}

// Walks down to the centre's leaf, and keeps the nodes on the way.
inline std::uint32_t CornerLeaves::find_own() {
  const std::uint32_t packed = pack(cell_[0][0], cell_[0][1], cell_[0][2], below_);
  std::uint32_t node = directory_entry(0);
  std::uint32_t left = below_;
  path_[left] = node;
  while (left != 0 && node != kNoNode) {  // bound: levels_below
    --left;
    node = step_down(view_, node, octant_of(packed, left));
    path_[left] = node;
  }
  path_end_ = left;
  return node;
}

// Starts where the way to this corner parts from the one to the centre.
inline std::uint32_t CornerLeaves::find_other(std::uint32_t corner) const {
  const std::uint32_t x = pick(cell_, corner, 0);
  const std::uint32_t y = pick(cell_, corner, 1);
  const std::uint32_t z = pick(cell_, corner, 2);
  const std::uint32_t differing = (x ^ cell_[0][0]) | (y ^ cell_[0][1]) | (z ^ cell_[0][2]);
  std::uint32_t left = below_;
  std::uint32_t node = kNoNode;
  if (differing >> below_ != 0) {
    node = directory_entry(corner);
  } else {
    left = 1;
    while (differing >> left != 0) {  // bound: levels_below
      ++left;
    }
    if (left < path_end_) {
      return kNoNode;
    }
    node = path_[left];
  }
  const std::uint32_t packed = pack(x, y, z, below_);
  while (left != 0 && node != kNoNode) {  // bound: levels_below
    --left;
    node = step_down(view_, node, octant_of(packed, left));
  }
  return node;
}

inline void CornerLeaves::describe(std::uint32_t number, NearLeaf& leaf) const {
  leaf.number = number;
  leaf.first_point = view_.first_point(number);
  leaf.end_point = view_.first_point(number + 1U);
  leaf.corner = corner_;
  leaf.site_m = 2.0F * view_.step_m();
  leaf.local = {pick(local_, corner_, 0), pick(local_, corner_, 1), pick(local_, corner_, 2)};
}

// The sum is rounded by less than the unit that each gap is short of.
inline bool CornerLeaves::is_beyond(std::uint32_t corner, float limit_squared) const {
  return pick(gap_squared_, corner, 0) + pick(gap_squared_, corner, 1) +
             pick(gap_squared_, corner, 2) >
         limit_squared;
}

inline bool CornerLeaves::next_inlined(float limit_squared, NearLeaf& leaf) {
  if (!view_.is_uniform()) {
    return next_mixed(limit_squared, leaf);
  }
  std::uint32_t number = kNoNode;
  if (corner_ == kBegin) {
    corner_ = 0;
    number = find_own();
  }
  if (corner_ == 0 && number == kNoNode) {
    drop_axes(limit_squared);
  }
  while (number == kNoNode && corner_ != axes_left_) {  // bound: 7
    corner_ = (corner_ - axes_left_) & axes_left_;      // the next subset of the axes
    if (!is_beyond(corner_, limit_squared)) {
      number = find_other(corner_);
    }
  }
  if (number == kNoNode) {
    return false;
  }
  describe(number, leaf);
  return true;
}

// Of those axes whose other cells are beyond the limit, no corner is left.
inline void CornerLeaves::drop_axes(float limit_squared) {
  axes_left_ &= (gap_squared_[1][0] > limit_squared ? 6U : 7U) &
                (gap_squared_[1][1] > limit_squared ? 5U : 7U) &
                (gap_squared_[1][2] > limit_squared ? 3U : 7U);
}

}  // namespace tactree::core
