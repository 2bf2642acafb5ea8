#pragma once
// The eight-corner rule: if no leaf is smaller than the cube centre +- r, the leaves that contain
// the eight corners of the cube are all the leaves that it touches. (On each axis the cube is no
// longer than a leaf, so a leaf that meets it contains one of its two ends.)
// Loop and memory annotations: docs/BOUND.md.

#include "lanes.hpp"
#include "tactree/core/model/octree.hpp"

namespace tactree::core {

/// A cell of the finest level, counted from the lower corner of the root cube.
struct Cell {
  std::uint32_t x;
  std::uint32_t y;
  std::uint32_t z;
};
/// Finds the leaf that contains the cell, starting at node `node` of level `level`, which must
/// contain it. Returns false in empty space, and after a memory fault.
[[nodiscard]] bool descend(const BlobView& view, std::uint32_t node, std::uint32_t level, Cell cell,
                           Leaf& leaf);

/// A leaf and a position relative to it, for a search through its points.
struct NearLeaf {
  std::uint32_t number = 0;
  std::uint32_t first_point = 0;
  std::uint32_t end_point = 0;  ///< one past the last
  std::uint32_t corner = 0;     ///< corner of the cube that the leaf contains, 0 .. 7
  float site_m = 0.0F;          ///< spacing of the sites, m
  std::int32_t half_site = 1;   ///< half the spacing, lattice units
  Vec3 local{};                 ///< the position, m, relative to the leaf's first site

  bool damaged = false;  ///< memory fault: the model has no such leaf or points

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
/// There are no leaves unless 0 <= r <= view.reach_m() and the centre is finite. Cost: at most 8
/// descents of at most depth() levels, about 20 instructions per level. Levels above the directory,
/// and those shared with the descent to the centre, are skipped.
class CornerLeaves {
 public:
  CornerLeaves(const BlobView& view, Vec3 centre, float r);

  /// Calls limit_squared = visit(leaf) for each leaf, beginning with the centre's. Skips leaves
  /// whose cells are further from the centre than the square root of limit_squared (m^2) plus two
  /// lattice units. The limit must not increase; a negative limit ends the search.
  template <typename Visit>
  void each(float limit_squared, Visit&& visit);

  /// Iteration without a callback: begin(), then find(corner) for corner 0 and for each corner that
  /// next() returns, until it returns 0. begin() returns false if there are no leaves.
  [[nodiscard]] bool begin();
  [[nodiscard]] std::uint32_t next(std::uint32_t corner) const {
    return (corner - axes_left_) & axes_left_;
  }
  [[nodiscard]] bool is_beyond(std::uint32_t corner, float limit_squared) const;
  /// The result is empty if there is no leaf, or if the leaf is returned for another corner.
  [[nodiscard]] NearLeaf find(std::uint32_t corner);

  /// Lower corner of a visited leaf, lattice units.
  [[nodiscard]] Int3 min_of(const NearLeaf& leaf) const;
  /// All data of a visited leaf.
  [[nodiscard]] Leaf leaf(std::uint32_t number, std::uint32_t corner) const;

 private:
  static constexpr std::uint32_t kAxes = kLanes > 1 ? kLanes : 3;  // padded to whole lanes

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
  std::uint32_t axes_left_ = 0;  // bit n: the other cell of axis n is within reach
  // On each axis: [0] the finest cell of the centre, [1] the cell beyond its nearest face.
  std::uint32_t cell_[2][kAxes];    // number of the cell from the lower corner of the root
  std::uint32_t packed_[2][kAxes];  // the bits below the directory level, for octant_of()
  float local_[2][kAxes];           // the centre, m, relative to the cell's first site
  float gap_squared_[2][kAxes];  // squared distance of the cell from the centre, m^2, rounded down
  std::uint32_t own_packed_ = 0;
  std::uint32_t axes_across_ = 0;  // bit n: the cells of axis n have different directory entries
  // The descent to the centre, by number of levels below: nodes, and at 0 the number of the leaf.
  std::uint32_t path_[kMaxLevelsBelow + 1];
  std::uint32_t path_end_ = 0;   // index of its last entry; 0: it reached the leaf
  std::uint32_t own_ = kNoNode;  // number of that leaf
};

// `packed` contains three coordinates of ten bits each. The product moves the bits of one level
// from positions 0, 10 and 20 to the top three positions.
static_assert(kMaxLevelsBelow <= 10);
constexpr std::uint32_t octant_of(std::uint32_t packed, std::uint32_t level_below) {
  return ((packed >> level_below) & 0x00100401U) * 0x20100800U >> 29;
}
static_assert(octant_of(4U << 10, 2) == 2 && octant_of(7U | 3U << 10 | 4U << 20, 2) == 5);

// Result of a descent that ended above the leaves: kNoNode in empty space, otherwise kDamagedNode
// (memory fault).
constexpr std::uint32_t kDamagedNode = kNoNode - 1U;
constexpr std::uint32_t stopped_at(std::uint32_t node) {
  return node == kNoNode ? kNoNode : kDamagedNode;
}

// The child of a node whose children are all of one kind; kNoNode if there is none.
// Precondition: node < view.node_count().
inline std::uint32_t step_down(const BlobView& view, std::uint32_t node, std::uint32_t octant) {
  const std::uint32_t group = view.node_words()[node];  // memory: flash
  const std::uint32_t mask = group >> 24;
  const std::uint32_t bit = 1U << octant;
  return (mask & bit) != 0 ? (group & 0xFFFFFFU) + count_low_octants(mask & (bit - 1U)) : kNoNode;
}

// Descends to the centre's leaf and records the nodes in path_. The descent ends early at kNoNode,
// or after a memory fault at an index that is out of range.
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

// Starts where the descent to this corner diverges from the one to the centre.
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
  const std::uint32_t found = corner == 0 ? own_ : find_other(corner);
  const bool exists = found < view_.leaf_count();
  const std::uint32_t number = exists ? found : 0U;  // placeholder: every model has leaf 0
  NearLeaf leaf{number,
                view_.first_point(number),
                view_.first_point(number + 1U),
                corner,
                2.0F * view_.step_m(),
                1,
                {pick(local_, corner, 0), pick(local_, corner, 1), pick(local_, corner, 2)},
                false};
  const bool is_sound = exists && view_.holds_points(leaf.first_point, leaf.end_point);
  if (!is_sound) {
    leaf.end_point = leaf.first_point;
    leaf.damaged = exists || found != kNoNode;
  }
  return leaf;
}

inline std::uint32_t CornerLeaves::axes_within(float limit_squared) const {
  return axes_left_ & (gap_squared_[1][0] > limit_squared ? 6U : 7U) &
         (gap_squared_[1][1] > limit_squared ? 5U : 7U) &
         (gap_squared_[1][2] > limit_squared ? 3U : 7U);
}

// The rounding error of the sum is smaller than the lattice unit by which each gap is reduced.
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
    corner = (corner - axes) & axes;  // the next subset of the axes; 0 after the last
  } while (corner != 0);
}

}  // namespace tactree::core
