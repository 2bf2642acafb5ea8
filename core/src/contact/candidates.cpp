// Gathers the points near the centre, in slices that fit into a tick.
// Loop and memory annotations: docs/BOUND.md.
// memory: RAM

#include "tactree/core/contact/candidates.hpp"

#include "contact/face_fits.hpp"
#include "model/corner_leaves.hpp"
#include "tactree/core/contact/neighbour.hpp"

namespace tactree::core {
namespace {

// Maximum stride of a query that predicts the next one, in slacks. A query that goes straight on
// leaves a set after 1.7, one that turns back after 0.3. A slow query begins the next gather at a
// stride just above 1; a longer stride is a jump or a step of a sweep, which is 2.5 with a support
// radius of 2.5 and a reach of 3 spacings.
constexpr float kStride = 1.5F;

// Rounding a centre to integers moves it by less than kRounding. In total, a gather loses less than
// kLostToRounding lattice units of its reach: the rounded centre, the reach rounded down, and the
// rounded distance of a point.
constexpr std::int32_t kRounding = 1;
constexpr float kLostToRounding = 3.0F;

constexpr std::uint32_t lower(std::uint32_t a, std::uint32_t b) { return a < b ? a : b; }

/// Rounds to the nearest integer, for |value| < 2^15.
constexpr std::int32_t rounded(float value) {
  constexpr float kPositive = 32768.0F;
  return static_cast<std::int32_t>(value + (kPositive + 0.5F)) -
         static_cast<std::int32_t>(kPositive);
}

/// The ball of a gather in the integer coordinates of one leaf. Most points are outside, and
/// comparing integers is faster than comparing floats. Unit: half a site, counted from the leaf's
/// first site; the centre is rounded to it. In a uniform blob this unit is the lattice unit, and
/// the radius is reduced by the rounding error. In a blob with leaves of several sizes the unit may
/// be coarse: the radius is enlarged, and the points inside are compared again exactly.
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

  /// Range of the words in the slab of z that the ball touches; words ascend with z. The range is
  /// empty if the first exceeds the last.
  [[nodiscard]] std::uint32_t first_word() const { return first_word_; }
  [[nodiscard]] std::uint32_t last_word() const { return last_word_; }

  /// Offset of a point from the centre, half sites.
  [[nodiscard]] Int3 offset_of(std::uint32_t word) const {
    return {2 * static_cast<std::int32_t>(word >> 2 & 1023U) - centre_.x,
            2 * static_cast<std::int32_t>(word >> 12 & 1023U) - centre_.y,
            2 * static_cast<std::int32_t>(word >> kZShift) - centre_.z};
  }
  [[nodiscard]] bool holds(Int3 offset) const {
    return offset.x * offset.x + offset.y * offset.y + offset.z * offset.z <= radius_squared_;
  }
  /// Exact position of a point, lattice units.
  [[nodiscard]] Int3 place_of(Int3 offset) const {
    return {origin_.x + half_site_ * offset.x, origin_.y + half_site_ * offset.y,
            origin_.z + half_site_ * offset.z};
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

float CandidateSet::slack_of(const BlobView& view) {
  return view.reach_m() - view.support_radius_m() - kLostToRounding * view.step_m();
}

// A centre ahead of a moving query stays valid 1 + kCentreAhead times as long as one at the query.
Vec3 CandidateSet::centre_for(const BlobView& view, Vec3 x) const {
  const float slack = slack_of(view);
  const Vec3 stride = x - centre_;
  const float squared = length_squared(stride);
  const bool predictable =
      state_ == State::kValid && squared > 0.0F && squared <= kStride * slack * (kStride * slack);
  return predictable ? x + (kCentreAhead * slack / square_root(squared)) * stride : x;
}

void CandidateSet::begin(const BlobView& view, Vec3 centre) {
  const float slack = slack_of(view);
  slack_squared_ = slack * slack;
  centre_ = centre;
  state_ = State::kGathering;
  count_ = 0;
  hidden_ = 0;
  corner_ = 0;
  in_leaf_ = false;
  const BlobHeader& header = view.header();
  most_ = lower(header.points_per_ball_max, kMaxCandidates);                 // memory: flash
  most_in_support_ = lower(points_per_support_max(header), kMaxCandidates);  // memory: flash
  unseen_ = header.points_per_query_max;                                     // memory: flash
  untested_ = header.points_per_slab_max;                                    // memory: flash
}

[[gnu::always_inline]] inline bool CandidateSet::gather_corner(const BlobView& view,
                                                               CornerLeaves& corners,
                                                               GatherSlice& left) {
  if (corners.is_beyond(corner_, view.reach_m() * view.reach_m())) {
    return true;
  }
  const NearLeaf leaf = corners.find(corner_);
  complete_ = complete_ && !leaf.damaged;
  // at most: slice_corners per Proxy::update
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
  state_ = done ? State::kValid : State::kGathering;
  return done;
}

void CandidateSet::cover(const BlobView& view, Vec3 x) {
  if (view.empty()) {
    clear();
    count_ = 0;
    hidden_ = 0;
  } else if (!covers(x)) {
    begin(view, centre_for(view, x));
    GatherSlice all;
    (void)gather(view, all);
  }
}

// The body occupies the region behind at least one `holding` face and behind all `ending` faces.
// The loop reads the faces from locals, which a compiler keeps in registers.
[[gnu::noinline]] void CandidateSet::hide(const Neighbour& neighbour, float side) {
  const NeighbourFace none{{}, 1e30F};  // no effect as an ending face
  const std::uint32_t faces = neighbour.holding + neighbour.ending;
  const NeighbourFace a = neighbour.face[0];
  const NeighbourFace b = faces > 1U ? neighbour.face[1] : none;
  const NeighbourFace c = faces > 2U ? neighbour.face[2] : none;
  const bool b_holds = neighbour.holding > 1U;
  const bool c_holds = neighbour.holding > 2U;
  const float tolerance = neighbour.tolerance_m;
  const std::uint32_t all = count_ + hidden_;
  std::uint32_t shown = 0;
  for (std::uint32_t i = 0; i < all; ++i) {  // bound: points_per_ball_max
    const Vec3 position = candidates_[i].position;
    float height = a.height_of(position);
    const NeighbourFace* facing = &a;
    const float b_height = b.height_of(position);
    if (b_holds == (b_height < height)) {
      height = b_height;
      facing = &b;
    }
    const float c_height = c.height_of(position);
    if (c_holds == (c_height < height)) {
      height = c_height;
      facing = &c;
    }
    const bool continues = side * dot(candidates_[i].normal, facing->normal) > kCreaseCosine;
    if (height > tolerance || (height >= -tolerance && continues)) {
      const Candidate candidate = candidates_[i];
      candidates_[i] = candidates_[shown];
      candidates_[shown++] = candidate;
    }
  }
  count_ = shown;
  hidden_ = all - shown;
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

// A blob that holds more points than it declares must not make a tick longer than the proven bound.
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
    length = 0U;                                   // no word is below first_word
  }
  while (length != 0U) {  // bound: kLeafHalvings
    const std::uint32_t half = length / 2U;
    const bool is_below = words[low + half] < first_word;  // memory: flash
    low = is_below ? low + half + 1U : low;                // memory: flash
    length = is_below ? length - half - 1U : half;         // memory: flash
  }
  next_ = low;
}

// Returns false if the slice is exhausted within the leaf.
[[gnu::noinline]] bool CandidateSet::gather_leaf(const BlobView& view, const NearLeaf& leaf,
                                                 Int3 leaf_min, GatherSlice& left) {
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
    const Int3 offset = ball.offset_of(words[index]);         // memory: flash
    is_full = ball.holds(offset) && !add(view, ball.place_of(offset), index, room);
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

const Candidate* nearest_candidate(const CandidateSet& set, Vec3 x, float radius) {
  float best = radius * radius;
  const Candidate* nearest = nullptr;
  for (const Candidate& candidate : set) {  // bound: points_per_ball_max
    const float squared = length_squared(candidate.position - x);
    if (squared < best) {
      best = squared;
      nearest = &candidate;
    }
  }
  return nearest;
}

}  // namespace tactree::core
