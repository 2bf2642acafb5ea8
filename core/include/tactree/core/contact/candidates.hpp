#pragma once
// The candidate set: decoded points around a centre, gathered in slices that fit a tick.
//
// Interrupt safety: no shared state; one context owns a set.

#include <cstdint>

#include "tactree/core/contact/surface_work.hpp"
#include "tactree/core/model/blob.hpp"

namespace tactree::core {

struct NearLeaf;
struct Neighbour;
class CornerLeaves;

/// Capacity of a set. surface_support() refuses a blob with a larger points_per_ball_max.
inline constexpr std::uint32_t kMaxCandidates = 128;

/// Halvings of a leaf's points by binary search. surface_support() refuses a blob with a leaf of
/// 2^kLeafHalvings points or more.
inline constexpr std::uint32_t kLeafHalvings = 8;

/// A decoded point.
struct Candidate {
  Vec3 position{};          ///< m, model frame
  Vec3 normal{};            ///< unit length
  std::uint32_t point = 0;  ///< index in the blob
};

/// Valid for queries within slack_of() of the centre of the last gather.
class CandidateSet {
 public:
  /// Largest distance of a query from the centre, m. Not positive if the blob lacks the guarantee
  /// reach > support radius.
  [[nodiscard]] static float slack_of(const BlobView& view);

  /// Empties the set and makes complete() true. Required whenever the blob changes.
  void clear() {
    state_ = State::kEmpty;
    complete_ = true;
  }

  /// The set is valid for a query at `x`.
  [[nodiscard]] bool covers(Vec3 x) const { return state_ == State::kValid && is_near(x); }
  /// The set covers `x`, now or once the gather in progress ends.
  [[nodiscard]] bool will_cover(Vec3 x) const { return state_ != State::kEmpty && is_near(x); }
  /// A gather is in progress; the candidates must not be used.
  [[nodiscard]] bool is_gathering() const { return state_ == State::kGathering; }
  /// Begins a gather around a centre ahead of `x`, in the direction in which the query moves.
  void begin_for(const BlobView& view, Vec3 x);
  /// Continues the gather and reduces `left` by the work done; true: the gather has ended.
  /// Cost: at most `left`; a whole gather visits 8 leaves with points_per_query_max points,
  /// compares points_per_slab_max and decodes points_per_ball_max of them.
  bool gather(const BlobView& view, GatherSlice& left);
  /// Gathers around `x` without a limit unless the set covers it. For use outside a tick.
  void cover(const BlobView& view, Vec3 x);

  /// Hides the points where another body leaves no surface: those within it, and those on one of
  /// its faces that do not continue it, as those of flush faces that are opposite each other. Shows
  /// the others. `side`: 1, or -1 if the probe is on the side that the normals avert. Precondition:
  /// neighbour.holding > 0. Cost: one pass over the set.
  void hide(const Neighbour& neighbour, float side);
  void show_all() {
    count_ += hidden_;
    hidden_ = 0;
  }
  [[nodiscard]] std::uint32_t hidden() const { return hidden_; }

  /// Of the points that are not hidden, as all below.
  [[nodiscard]] std::uint32_t count() const { return count_; }
  /// False after a gather that left points out because the blob holds more than it declares or
  /// than kMaxCandidates; clear() makes it true.
  [[nodiscard]] bool complete() const { return complete_; }
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
  std::uint32_t hidden_ = 0;    // behind the others
  std::uint32_t most_ = 0;      // limit of count_: declared by the blob, at most kMaxCandidates
  std::uint32_t unseen_ = 0;    // points left of points_per_query_max
  std::uint32_t untested_ = 0;  // points left of points_per_slab_max
  std::uint32_t corner_ = 0;
  std::uint32_t next_ = 0;  // point of the leaf at corner_ where the gather continues; if in_leaf_
  std::uint32_t end_ = 0;   // one behind the leaf's last point; if in_leaf_
  bool in_leaf_ = false;
  Vec3 centre_{};
  float slack_squared_ = 0.0F;  // m^2
  State state_ = State::kEmpty;
  bool complete_ = true;
};

/// The candidate nearest to `x` within `radius` (m); null: none. Cost: one pass over the set.
[[nodiscard]] const Candidate* nearest_candidate(const CandidateSet& set, Vec3 x, float radius);

}  // namespace tactree::core
