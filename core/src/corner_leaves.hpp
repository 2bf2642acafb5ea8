#pragma once
// The eight-corner rule: where no leaf is smaller than the cube centre +- r, the leaves that hold
// its eight corners are all the leaves it touches. (On each axis the cube is no longer than a leaf,
// so a leaf that meets it contains one of its two ends.)

#include "lanes.hpp"
#include "tactree/core/octree.hpp"

namespace tactree::core {

/// A cell of the finest level, counted from the root's lower corner.
struct Cell {
  std::uint32_t x;
  std::uint32_t y;
  std::uint32_t z;
};
/// The leaf that holds the cell, below a node of that level which does, too. False: empty space.
[[nodiscard]] bool descend(const BlobView& view, std::uint32_t node, std::uint32_t level, Cell cell,
                           Leaf& leaf);

/// A leaf as seen from a place; what a search through its points needs.
struct NearLeaf {
  std::uint32_t number = 0;
  std::uint32_t first_point = 0;
  std::uint32_t end_point = 0;  ///< one behind its last
  std::uint32_t corner = 0;     ///< which of the eight it is of
  float site_m = 0.0F;          ///< length of a site
  std::int32_t half_site = 1;   ///< half of it, lattice units
  Vec3 local{};                 ///< of the place, m, counted from the leaf's first site

  bool damaged = false;  ///< a memory failed: the model has no such leaf, or points

  [[nodiscard]] bool empty() const { return end_point == first_point; }
};
[[nodiscard]] inline NearLeaf near_leaf(const BlobView& view, const Leaf& leaf, Vec3 place,
                                        std::uint32_t corner = 0) {
  const float step = view.step_m();
  const std::int32_t half_site = 1 << (view.depth() - leaf.level);
  const auto local = [&](float v, std::int32_t low) {
    return v - step * static_cast<float>(low + half_site);
  };
  return {leaf.number,
          leaf.first_point,
          leaf.first_point + leaf.point_count,
          corner,
          step * static_cast<float>(2 * half_site),
          half_site,
          {local(place.x, leaf.min.x), local(place.y, leaf.min.y), local(place.z, leaf.min.z)}};
}

/// The leaves that the cube centre +- r touches.
/// Precondition: 0 <= r <= view.reach_m(); for a larger or NaN r, or a centre that is not finite,
/// there are no leaves. Cost: at most 8 descents of at most depth() levels, about 20 instructions
/// each; what they share with the centre's, and levels above the directory, are not walked again.
class CornerLeaves {
 public:
  CornerLeaves(const BlobView& view, Vec3 centre, float r);

  /// limit_squared = visit(leaf) for each leaf, the centre's first, but for those whose cells are
  /// further than the square root of limit_squared (m^2) from the centre by then, by more than two
  /// lattice units. The limit may only shrink; a negative one ends the search.
  template <typename Visit>
  void each(float limit_squared, Visit&& visit);

  /// The same in steps: begin(), then find(corner) for 0 and all that next() tells, until it tells
  /// 0. False: there are no leaves.
  [[nodiscard]] bool begin();
  [[nodiscard]] std::uint32_t next(std::uint32_t corner) const {
    return (corner - axes_left_) & axes_left_;
  }
  [[nodiscard]] bool is_beyond(std::uint32_t corner, float limit_squared) const;
  /// Empty where there is no leaf, or it was told for another corner.
  [[nodiscard]] NearLeaf find(std::uint32_t corner);

  /// Lower corner of a leaf that was visited, lattice units.
  [[nodiscard]] Int3 min_of(const NearLeaf& leaf) const;
  /// The whole of it.
  [[nodiscard]] Leaf leaf(std::uint32_t number, std::uint32_t corner) const;

 private:
  static constexpr std::uint32_t kAxes = kLanes > 1 ? kLanes : 3;  // room for whole lanes

  template <typename T>
  [[nodiscard]] static T pick(const T (&of)[2][kAxes], std::uint32_t corner, std::uint32_t axis) {
    return of[corner >> axis & 1U][axis];
  }

  bool set_axes(Vec3 centre, float r);
  bool reach_in(std::uint32_t outside_axes);
  [[nodiscard]] std::uint32_t axes_within(float limit_squared) const;
  [[nodiscard]] bool find_mixed(std::uint32_t corner, Leaf& leaf) const;
  [[nodiscard]] std::uint32_t find_own();
  [[nodiscard]] std::uint32_t find_other(std::uint32_t corner) const;
  [[nodiscard]] std::uint32_t directory_entry(std::uint32_t corner) const;
  [[nodiscard]] Int3 lower_corner(std::uint32_t corner) const;

  const BlobView& view_;
  Vec3 centre_;
  bool is_valid_ = false;
  std::uint32_t below_;          // levels between the directory and the leaves
  std::uint32_t axes_left_ = 0;  // bit = an axis whose other cell is in reach
  // On each axis the centre's finest cell, and the one beyond its nearest face:
  std::uint32_t cell_[2][kAxes];    // counted from the root
  std::uint32_t packed_[2][kAxes];  // the bits below the directory, where octant_of() wants them
  float local_[2][kAxes];           // of the centre, m, counted from the cell's first site
  float gap_squared_[2][kAxes];     // m^2 from the centre to the cell, rounded down
  std::uint32_t own_packed_ = 0;
  std::uint32_t axes_across_ = 0;  // bit = an axis whose two cells are below different nodes there
  // The centre's descent, by levels below: the nodes, then the leaf's number.
  std::uint32_t path_[kMaxLevelsBelow + 1];
  std::uint32_t path_end_ = 0;   // where it ends: 0 is the leaf
  std::uint32_t own_ = kNoNode;  // that leaf
};

// The bits of three coordinates side by side, ten each: one product brings those of a level, 0, 10
// and 20, together at the top.
static_assert(kMaxLevelsBelow <= 10);
constexpr std::uint32_t octant_of(std::uint32_t packed, std::uint32_t level_below) {
  return ((packed >> level_below) & 0x00100401U) * 0x20100800U >> 29;
}
static_assert(octant_of(4U << 10, 2) == 2 && octant_of(7U | 3U << 10 | 4U << 20, 2) == 5);

// The number of no leaf; kNoNode only where there is none.
constexpr std::uint32_t kDamagedNode = kNoNode - 1U;
constexpr std::uint32_t stopped_at(std::uint32_t node) {
  return node == kNoNode ? kNoNode : kDamagedNode;
}

// The child of a node whose children are all of one kind; kNoNode: there is none.
// Precondition: node < view.node_count().
inline std::uint32_t step_down(const BlobView& view, std::uint32_t node, std::uint32_t octant) {
  const std::uint32_t group = view.node_words()[node];  // memory: flash
  const std::uint32_t mask = group >> 24;
  const std::uint32_t bit = 1U << octant;
  return (mask & bit) != 0 ? (group & 0xFFFFFFU) + count_low_octants(mask & (bit - 1U)) : kNoNode;
}

// Walks down to the centre's leaf, and keeps the nodes on the way. What it stops at is kNoNode, or
// what a memory that failed took for a node: neither is the number of one.
[[gnu::always_inline]] inline std::uint32_t CornerLeaves::find_own() {
  const std::uint32_t nodes = view_.node_count();
  std::uint32_t node = directory_entry(0);
  std::uint32_t left = below_;
  path_[left] = node;
  while (left != 0 && node < nodes) {  // bound: levels_below
    --left;
    node = step_down(view_, node, octant_of(own_packed_, left));
    path_[left] = node;
  }
  path_end_ = left;
  return left == 0 ? node : stopped_at(node);
}

// Starts where the way to this corner parts from the one to the centre.
[[gnu::always_inline]] inline std::uint32_t CornerLeaves::find_other(std::uint32_t corner) const {
  const std::uint32_t packed =
      pick(packed_, corner, 0) | pick(packed_, corner, 1) | pick(packed_, corner, 2);
  std::uint32_t left = below_;
  std::uint32_t node = kNoNode;
  if ((corner & axes_across_) != 0) {
    node = directory_entry(corner);
  } else {
    const std::uint32_t each = packed ^ own_packed_;
    const std::uint32_t differing = (each | each >> 10 | each >> 20) & 1023U;
    left = 1;
    while (differing >> left != 0) {  // bound: levels_below
      ++left;
    }
    node = left < path_end_ ? kNoNode : path_[left];
  }
  const std::uint32_t nodes = view_.node_count();
  while (left != 0 && node < nodes) {  // bound: levels_below
    --left;
    node = step_down(view_, node, octant_of(packed, left));
  }
  return left == 0 ? node : stopped_at(node);
}

[[gnu::always_inline]] inline bool CornerLeaves::begin() {
  if (is_valid_ && view_.is_uniform()) {
    own_ = find_own();
  }
  return is_valid_;
}

[[gnu::always_inline]] inline NearLeaf CornerLeaves::find(std::uint32_t corner) {
  if (!view_.is_uniform()) {
    Leaf leaf;
    const bool found = find_mixed(corner, leaf);  // at most: 8 * mixed per CandidateSet::gather
    return found ? near_leaf(view_, leaf, centre_, corner) : NearLeaf{};
  }
  const std::uint32_t number = corner == 0 ? own_ : find_other(corner);
  if (number >= view_.leaf_count()) {
    NearLeaf none;
    none.damaged = number != kNoNode;
    return none;
  }
  NearLeaf leaf{number,
                view_.first_point(number),
                view_.first_point(number + 1U),
                corner,
                2.0F * view_.step_m(),
                1,
                {pick(local_, corner, 0), pick(local_, corner, 1), pick(local_, corner, 2)}};
  if (!view_.holds_points(leaf.first_point, leaf.end_point)) {
    leaf.end_point = leaf.first_point;
    leaf.damaged = true;
  }
  return leaf;
}

inline std::uint32_t CornerLeaves::axes_within(float limit_squared) const {
  return axes_left_ & (gap_squared_[1][0] > limit_squared ? 6U : 7U) &
         (gap_squared_[1][1] > limit_squared ? 5U : 7U) &
         (gap_squared_[1][2] > limit_squared ? 3U : 7U);
}

// The sum is rounded by less than the unit that each gap is short of.
inline bool CornerLeaves::is_beyond(std::uint32_t corner, float limit_squared) const {
  return pick(gap_squared_, corner, 0) + pick(gap_squared_, corner, 1) +
             pick(gap_squared_, corner, 2) >
         limit_squared;
}

template <typename Visit>
[[gnu::always_inline]] inline void CornerLeaves::each(float limit_squared, Visit&& visit) {
  if (!begin()) {
    return;
  }
  std::uint32_t axes = axes_left_;
  std::uint32_t corner = 0;
  do {  // bound: 8
    const bool is_first = corner == 0;
    if (!is_beyond(corner, limit_squared)) {
      const NearLeaf leaf = find(corner);
      if (!leaf.empty()) {
        limit_squared = visit(leaf);
      }
    }
    axes = is_first ? axes_within(limit_squared) : axes;
    corner = (corner - axes) & axes;  // the next subset of the axes, in the end none
  } while (corner != 0);
}

}  // namespace tactree::core
