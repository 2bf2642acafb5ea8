// memory: RAM

#include "corner_leaves.hpp"
#include "tactree/core/surface.hpp"

namespace tactree::core {
namespace {

// The next gather, in slacks: how far ahead of the query, less than 1; and from which stride on the
// query has jumped, so that nobody knows where it goes.
constexpr float kAhead = 0.7F;
constexpr float kStride = 1.5F;

// A centre rounded to whole numbers is off by less than kRounding of them. So much less than the
// reach is gathered, the reach is rounded down, and a point may seem further than it is.
constexpr std::int32_t kRounding = 1;
constexpr float kLostToRounding = 3.0F;

constexpr std::uint32_t lower(std::uint32_t a, std::uint32_t b) { return a < b ? a : b; }

/// To the nearest whole number, for |value| < 2^15.
constexpr std::int32_t rounded(float value) {
  constexpr float kPositive = 32768.0F;
  return static_cast<std::int32_t>(value + (kPositive + 0.5F)) -
         static_cast<std::int32_t>(kPositive);
}

/// Which points of a leaf are near the centre of a gather, in whole numbers: comparing floats takes
/// longer, and most points are not near enough. Counted in half sites from the leaf's first site,
/// to which the centre is rounded: where all leaves are of one size these are lattice units, and
/// the reach is taken smaller by as much. Leaves of several sizes may be coarse: there it is taken
/// larger, and what is within is compared exactly.
class LeafBall {
 public:
  LeafBall(const BlobView& view, const NearLeaf& leaf, Int3 leaf_min) {
    const float inverse = view.is_uniform() ? view.inverse_step() : 2.0F / leaf.site_m;
    const auto reach = static_cast<std::int32_t>(view.reach_m() * inverse);
    const std::int32_t radius = view.is_uniform() ? reach - kRounding : reach + 2 * kRounding;
    centre_ = {rounded(leaf.local.x * inverse), rounded(leaf.local.y * inverse),
               rounded(leaf.local.z * inverse)};
    radius_squared_ = radius * radius;
    const std::int32_t half = leaf.half_site;
    origin_ = {leaf_min.x + half * (1 + centre_.x), leaf_min.y + half * (1 + centre_.y),
               leaf_min.z + half * (1 + centre_.z)};
    half_site_ = half;
    const std::int32_t lowest = (centre_.z - radius + 1) >> 1;
    const std::int32_t highest = (centre_.z + radius) >> 1;
    if (lowest <= kLastSite && highest >= 0) {
      first_word_ = lowest > 0 ? static_cast<std::uint32_t>(lowest) << kZShift : 0U;
      last_word_ =
          highest < kLastSite ? ((static_cast<std::uint32_t>(highest) + 1U) << kZShift) - 1U : ~0U;
    }
  }

  /// Words ascend with z: these are the ends of the slab that the ball touches; none where the
  /// first is beyond the last.
  [[nodiscard]] std::uint32_t first_word() const { return first_word_; }
  [[nodiscard]] std::uint32_t last_word() const { return last_word_; }

  /// From the centre to the point, half sites.
  [[nodiscard]] Int3 way_to(std::uint32_t word) const {
    return {2 * static_cast<std::int32_t>(word >> 2 & 1023U) - centre_.x,
            2 * static_cast<std::int32_t>(word >> 12 & 1023U) - centre_.y,
            2 * static_cast<std::int32_t>(word >> kZShift) - centre_.z};
  }
  [[nodiscard]] bool holds(Int3 way) const {
    return way.x * way.x + way.y * way.y + way.z * way.z <= radius_squared_;
  }
  /// In lattice units; exact.
  [[nodiscard]] Int3 place_of(Int3 way) const {
    return {origin_.x + half_site_ * way.x, origin_.y + half_site_ * way.y,
            origin_.z + half_site_ * way.z};
  }

 private:
  static constexpr std::uint32_t kZShift = 22;
  static constexpr std::int32_t kLastSite = 1023;

  Int3 centre_{};
  Int3 origin_{};  // the centre, lattice units
  std::int32_t radius_squared_ = 0;
  std::int32_t half_site_ = 1;  // lattice units
  std::uint32_t first_word_ = ~0U;
  std::uint32_t last_word_ = 0;
};

}  // namespace

// How far from the centre of a gather its candidates are good. A centre that was rounded to the
// lattice leaves out what is almost a reach away.
float CandidateSet::slack_of(const BlobView& view) {
  return view.reach_m() - view.support_radius_m() - kLostToRounding * view.step_m();
}

// Ahead of a query that walks: it is then good for twice as long.
void CandidateSet::begin_for(const BlobView& view, Vec3 x) {
  const float slack = slack_of(view);
  const Vec3 way = x - centre_;
  const float squared = length_squared(way);
  const bool walks = valid_ && squared > 0.0F && squared <= kStride * slack * (kStride * slack);
  slack_squared_ = slack * slack;
  centre_ = walks ? x + (kAhead * slack / square_root(squared)) * way : x;
  valid_ = false;
  begun_ = true;
  complete_ = true;
  count_ = 0;
  corner_ = 0;
  in_leaf_ = false;
  const BlobHeader& header = view.header();
  most_ = lower(header.points_per_ball_max, kMaxCandidates);  // memory: flash
  unseen_ = header.points_per_query_max;                      // memory: flash
  untested_ = header.points_per_slab_max;                     // memory: flash
}

[[gnu::always_inline]] inline bool CandidateSet::gather_corner(const BlobView& view,
                                                               CornerLeaves& corners,
                                                               GatherSlice& left) {
  if (corners.is_beyond(corner_, view.reach_m() * view.reach_m())) {
    return true;
  }
  const NearLeaf leaf = corners.find(corner_);
  complete_ = complete_ && !leaf.damaged;
  return leaf.empty() || gather_leaf(view, leaf, corners.min_of(leaf), left);
}

[[gnu::noinline]] bool CandidateSet::gather(const BlobView& view, GatherSlice& left) {
  CornerLeaves corners(view, centre_, view.reach_m());
  bool done = !corners.begin();
  // total: slice_corners per Proxy::update
  // bound: min(8, slice_corners)
  while (!done && left.corners != 0U) {
    --left.corners;
    if (!gather_corner(view, corners, left)) {
      return false;
    }
    corner_ = corners.next(corner_);
    done = corner_ == 0U;
  }
  valid_ = done;
  begun_ = !done;
  return done;
}

void CandidateSet::cover(const BlobView& view, Vec3 x) {
  if (view.empty()) {
    clear();
    count_ = 0;
  } else if (!covers(x)) {
    begin_for(view, x);
    GatherSlice all;
    (void)gather(view, all);
  }
}

[[gnu::noinline]] bool CandidateSet::is_within(float reach, Vec3 position) const {
  return length_squared(position - centre_) <= reach * reach;
}

[[gnu::always_inline]] inline bool CandidateSet::add(const BlobView& view, Int3 place,
                                                     std::uint32_t point, std::uint32_t room) {
  const Vec3 position = {view.step_m() * static_cast<float>(place.x),
                         view.step_m() * static_cast<float>(place.y),
                         view.step_m() * static_cast<float>(place.z)};
  // at most: mixed * points_per_slab_max per CandidateSet::gather
  if (!view.is_uniform() && !is_within(view.reach_m(), position)) {
    return true;
  }
  if (count_ == room) {
    return false;
  }
  candidates_[count_] = {position, view.normal(point), point};
  // at most: points_per_ball_max per CandidateSet::gather
  // at most: slice_candidates per Proxy::update
  // at most: slice_candidates per CandidateSet::gather
  ++count_;
  return true;
}

// A blob that holds more than it declares must not make a tick longer than was proven.
void CandidateSet::begin_leaf(const BlobView& view, const NearLeaf& leaf,
                              std::uint32_t first_word) {
  const std::uint32_t count = leaf.end_point - leaf.first_point;
  const std::uint32_t most = lower(unseen_, (1U << kLeafHalvings) - 1U);
  complete_ = complete_ && count <= most;
  end_ = leaf.first_point + lower(count, most);
  unseen_ -= end_ - leaf.first_point;
  const std::uint32_t* const words = view.point_words();
  std::uint32_t low = leaf.first_point;
  std::uint32_t length = end_ - low;
  if (length != 0U && words[low] >= first_word) {  // memory: flash
    length = 0U;                                   // nothing is below
  }
  while (length != 0U) {  // bound: kLeafHalvings
    const std::uint32_t half = length / 2U;
    const bool is_below = words[low + half] < first_word;  // memory: flash
    low = is_below ? low + half + 1U : low;                // memory: flash
    length = is_below ? length - half - 1U : half;         // memory: flash
  }
  next_ = low;
}

// False: the slice is used up.
bool CandidateSet::gather_leaf(const BlobView& view, const NearLeaf& leaf, Int3 leaf_min,
                               GatherSlice& left) {
  const LeafBall ball(view, leaf, leaf_min);
  if (!in_leaf_) {
    begin_leaf(view, leaf, ball.first_word());
    in_leaf_ = true;
  }
  const std::uint32_t* const words = view.point_words();
  const std::uint32_t first = next_;
  const std::uint32_t last = first + lower(lower(end_ - first, untested_), left.points);
  const std::uint32_t room = lower(most_, count_ + left.candidates);
  const std::uint32_t count_before = count_;
  std::uint32_t index = first;
  bool is_full = false;
  // total: slice_points per Proxy::update
  // total: slice_points per CandidateSet::gather
  // bound: points_per_leaf_max, total points_per_slab_max per CandidateSet::gather
  while (index < last && words[index] <= ball.last_word()) {  // memory: flash
    const Int3 way = ball.way_to(words[index]);               // memory: flash
    is_full = ball.holds(way) && !add(view, ball.place_of(way), index, room);
    if (is_full) {
      break;
    }
    ++index;
  }
  next_ = index;
  untested_ -= index - first;
  left.points -= index - first;
  left.candidates -= count_ - count_before;
  const bool is_done = index == end_ || words[index] > ball.last_word();  // memory: flash
  const bool is_too_much = !is_done && (is_full ? count_ == most_ : untested_ == 0U);
  complete_ = complete_ && !is_too_much;
  in_leaf_ = !is_done && !is_too_much;
  return !in_leaf_;
}

SurfaceSupport surface_support(const BlobView& view) {
  if (view.empty()) {
    return SurfaceSupport::kEmpty;
  }
  const float radius = view.support_radius_m();
  if (!(radius > 0.0F) || !(CandidateSet::slack_of(view) > 0.0F)) {
    return SurfaceSupport::kNoReach;
  }
  const BlobHeader& header = view.header();
  const bool is_crowded = header.points_per_ball_max > kMaxCandidates;       // memory: flash
  const bool is_heaped = header.points_per_leaf_max >= 1U << kLeafHalvings;  // memory: flash
  if (is_crowded || is_heaped) {                                             // memory: flash
    return SurfaceSupport::kTooManyPoints;
  }
  return SurfaceSupport::kOk;
}

}  // namespace tactree::core
