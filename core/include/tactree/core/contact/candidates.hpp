#pragma once
// The candidate set: decoded points around a centre, gathered in slices that fit into a tick.
//
// Interrupt safety: no shared state; one context owns a set.
// Loop and memory annotations: docs/BOUND.md.
// memory: RAM

#include <cstdint>

#include "tactree/core/contact/surface_work.hpp"
#include "tactree/core/model/blob.hpp"

namespace tactree::core {

struct NearLeaf;
struct Neighbour;
class CornerLeaves;

/// Capacity of a set: an index and a flag fit into one byte (Division in passes.hpp).
/// surface_support() refuses a blob with a larger points_per_ball_max. A ball of 3 spacings holds
/// about 28 points of a plane (pi 3^2), and twice that of a thin plate. A set takes 3.5 KiB of RAM.
inline constexpr std::uint32_t kMaxCandidates = 128;

/// Maximum number of steps of the binary search in a leaf's points. surface_support() refuses a
/// blob with a leaf of 2^kLeafHalvings points or more. A leaf 6 spacings wide holds about 36 points
/// of a plane. Every step adds to the bound of a tick, in each leaf of a gather.
inline constexpr std::uint32_t kLeafHalvings = 8;

/// Distance of the centre of a set ahead of a query, in slacks. Below 1, so that the set covers the
/// query.
inline constexpr float kCentreAhead = 0.7F;

/// A decoded point.
struct Candidate {
  Vec3 position{};          ///< m, model frame
  Vec3 normal{};            ///< unit length
  std::uint32_t point = 0;  ///< index in the blob
};

/// A set is valid for queries within slack_of() of the centre of the last gather.
class CandidateSet {
 public:
  /// Maximum distance of a query from the centre, m. Not positive if the blob lacks the guarantee
  /// reach > support radius.
  [[nodiscard]] static float slack_of(const BlobView& view);

  /// Empties the set and makes complete() true. Required whenever the blob changes.
  void clear() {
    state_ = State::kEmpty;
    complete_ = true;
  }

  /// True if the set is valid for a query at `x`.
  [[nodiscard]] bool covers(Vec3 x) const { return state_ == State::kValid && is_near(x); }
  /// True if the set covers `x`, now or after the gather in progress.
  [[nodiscard]] bool will_cover(Vec3 x) const { return state_ != State::kEmpty && is_near(x); }
  /// True during a gather; the candidates must not be used then.
  [[nodiscard]] bool is_gathering() const { return state_ == State::kGathering; }
  /// The centre of a gather for a query at `x`: ahead of it, in the direction in which the query
  /// has moved away from the centre of this set.
  [[nodiscard]] Vec3 centre_for(const BlobView& view, Vec3 x) const;
  /// Begins a gather around `centre`.
  void begin(const BlobView& view, Vec3 centre);
  /// Continues the gather and reduces `left` by the work done. Returns true when it has ended.
  /// Cost: at most `left`. A complete gather visits 8 leaves with points_per_query_max points,
  /// compares points_per_slab_max and decodes points_per_ball_max of them.
  bool gather(const BlobView& view, GatherSlice& left);
  /// Gathers around `x` without a limit unless the set covers it. For use outside a tick.
  void cover(const BlobView& view, Vec3 x);

  /// Hides the points that are not on the surface of the union with another body: points inside it,
  /// and points on one of its faces whose normal does not continue that face, such as those of
  /// flush faces opposite each other. Shows all other points. `side`: 1 if the probe is on the side
  /// of the normals, -1 if it is on the other side. Precondition: neighbour.holding > 0. Cost: one
  /// pass over the set.
  void hide(const Neighbour& neighbour, float side);
  void show_all() {
    count_ += hidden_;
    hidden_ = 0;
  }
  [[nodiscard]] std::uint32_t hidden() const { return hidden_; }

  /// Centre of the last gather, m.
  [[nodiscard]] Vec3 centre() const { return centre_; }
  /// Number of points that are not hidden. Index and iterators cover only these.
  [[nodiscard]] std::uint32_t count() const { return count_; }
  /// Limit of the points in the support of a fit, declared by the blob.
  [[nodiscard]] std::uint32_t most_in_support() const { return most_in_support_; }
  /// False after a gather or a fit that omitted points because the blob holds more than it declares
  /// or than kMaxCandidates; clear() makes it true.
  [[nodiscard]] bool complete() const { return complete_; }
  /// To be called after a fit that omitted points.
  void report_omission() { complete_ = false; }
  [[nodiscard]] const Candidate& operator[](std::uint32_t i) const { return candidates_[i]; }
  [[nodiscard]] const Candidate* begin() const { return candidates_; }
  [[nodiscard]] const Candidate* end() const { return candidates_ + count_; }

 private:
  enum class State : std::uint8_t {
    kEmpty,
    kGathering,  // continues at corner_
    kValid,
  };

  [[nodiscard]] bool is_near(Vec3 x) const { return length_squared(x - centre_) <= slack_squared_; }
  [[nodiscard]] bool gather_corner(const BlobView& view, CornerLeaves& corners, GatherSlice& left);
  [[nodiscard]] bool gather_leaf(const BlobView& view, const NearLeaf& leaf, Int3 leaf_min,
                                 GatherSlice& left);
  void begin_leaf(const BlobView& view, const NearLeaf& leaf, std::uint32_t first_word);
  [[nodiscard]] bool is_within(float reach, Vec3 position) const;
  [[nodiscard]] bool add(const BlobView& view, Int3 place, std::uint32_t point, std::uint32_t room);

  Candidate candidates_[kMaxCandidates];
  std::uint32_t count_ = 0;
  std::uint32_t hidden_ = 0;  // stored after the others
  std::uint32_t most_ = 0;    // limit of count_: declared by the blob, at most kMaxCandidates
  std::uint32_t most_in_support_ = 0;
  std::uint32_t unseen_ = 0;    // remainder of points_per_query_max
  std::uint32_t untested_ = 0;  // remainder of points_per_slab_max
  std::uint32_t corner_ = 0;
  std::uint32_t next_ = 0;  // point at which the gather continues; valid if in_leaf_
  std::uint32_t end_ = 0;   // one past the leaf's last point; valid if in_leaf_
  bool in_leaf_ = false;
  Vec3 centre_{};
  float slack_squared_ = 0.0F;  // m^2
  State state_ = State::kEmpty;
  bool complete_ = true;
};

/// The candidate nearest to `x` within `radius` (m), or null. Cost: one pass over the set.
[[nodiscard]] const Candidate* nearest_candidate(const CandidateSet& set, Vec3 x, float radius);

}  // namespace tactree::core
