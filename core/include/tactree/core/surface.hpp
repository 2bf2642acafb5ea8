#pragma once
// The surface a hand feels between the points: an algebraic sphere fitted to the points around the
// query (APSS; Guennebaud and Gross, "Algebraic Point Set Surfaces", SIGGRAPH 2007).
//
// Interrupt safety of all that follows: no shared state; a set belongs to one context.

#include <cstdint>

#include "tactree/core/blob.hpp"

namespace tactree::core {

struct NearLeaf;  // of the search for leaves
class CornerLeaves;

/// Decoded points one gather can hold. A blob whose points_per_ball_max is larger is not loaded.
inline constexpr std::uint32_t kMaxCandidates = 128;

/// Nor one with a leaf of 2^kLeafHalvings points, which no longer are left after so many halvings.
inline constexpr std::uint32_t kLeafHalvings = 8;

/// How much of gathers may be done at a time.
struct GatherSlice {
  std::uint32_t corners = 8;         ///< of the cube around each, with a leaf at most
  std::uint32_t points = 65536;      ///< that are looked at
  std::uint32_t candidates = 65536;  ///< that are decoded
};

/// What the surface may cost in one tick; what is left waits for the next.
struct SurfaceWork {
  std::uint32_t gathers = 0;  ///< of candidates
  std::uint32_t passes = 0;   ///< over candidates: 1 a fit, 2 at a crease
  std::uint32_t all = 0;      ///< of both, where a gather counts as kGatherWork passes
  GatherSlice slice{};        ///< of all gathers
};
inline constexpr std::uint32_t kGatherWork = 2;
/// A tick's share of what a second may cost: the faster the loop, the less there is to do in a
/// tick. At least a slice of a gather or a fit at a crease: the fastest loops do the one or the
/// other.
inline constexpr std::uint32_t kPaces = 3;
inline constexpr SurfaceWork kWorkPerTick[kPaces] = {
    {4, 10, 13, {24, 288, 104}}, {2, 4, 4, {16, 160, 56}}, {1, 2, 2, {3, 48, 16}}};
/// A pace is for rates above this, Hz.
inline constexpr float kPaceRates[kPaces] = {0.0F, 1000.0F, 2000.0F};
[[nodiscard]] constexpr std::uint32_t pace_of(float rate_hz) {
  return rate_hz > kPaceRates[2] ? 2U : (rate_hz > kPaceRates[1] ? 1U : 0U);
}
[[nodiscard]] constexpr const SurfaceWork& work_per_tick(float rate_hz) {
  return kWorkPerTick[pace_of(rate_hz)];  // memory: flash
}

/// A decoded point.
struct Candidate {
  Vec3 position{};
  Vec3 normal{};
  std::uint32_t point = 0;  ///< its number in the blob
};

/// The decoded points around a centre, good for every query within the slack of that centre.
class CandidateSet {
 public:
  /// How far from its centre a gather is good, m.
  [[nodiscard]] static float slack_of(const BlobView& view);

  /// Forgets the last gather; needed whenever the blob changes.
  void clear() { valid_ = begun_ = false; }

  /// Is it good for a query at `x`, in the view of the last gather?
  [[nodiscard]] bool covers(Vec3 x) const { return valid_ && is_near(x); }
  /// Will it be, or is it, when the gather that was begun last is done?
  [[nodiscard]] bool will_cover(Vec3 x) const { return (valid_ || begun_) && is_near(x); }
  /// Has a gather begun that is not done yet? The set is not to be used then.
  [[nodiscard]] bool is_begun() const { return begun_; }
  /// Begins one around a place ahead of x, in the direction the query has moved.
  void begin_for(const BlobView& view, Vec3 x);
  /// Goes on with it while there is something `left`; true: done. Cost: what was left; for a whole
  /// gather 8 leaves of points_per_query_max points, of which points_per_slab_max are looked at and
  /// points_per_ball_max decoded.
  bool gather(const BlobView& view, GatherSlice& left);
  /// All at once.
  void cover(const BlobView& view, Vec3 x);

  [[nodiscard]] std::uint32_t count() const { return count_; }
  /// False: the blob held more points than it declares, or than kMaxCandidates, and some were left
  /// out.
  [[nodiscard]] bool complete() const { return complete_; }
  [[nodiscard]] const Candidate& operator[](std::uint32_t i) const { return candidates_[i]; }
  [[nodiscard]] const Candidate* begin() const { return candidates_; }
  [[nodiscard]] const Candidate* end() const { return candidates_ + count_; }

 private:
  [[nodiscard]] bool is_near(Vec3 x) const { return length_squared(x - centre_) <= slack_squared_; }
  [[nodiscard]] bool gather_corner(const BlobView& view, CornerLeaves& corners, GatherSlice& left);
  [[nodiscard]] bool gather_leaf(const BlobView& view, const NearLeaf& leaf, Int3 leaf_min,
                                 GatherSlice& left);
  void begin_leaf(const BlobView& view, const NearLeaf& leaf, std::uint32_t first_word);
  [[nodiscard]] bool is_within(float reach, Vec3 position) const;
  [[nodiscard]] bool add(const BlobView& view, Int3 place, std::uint32_t point, std::uint32_t room);

  Candidate candidates_[kMaxCandidates];
  std::uint32_t count_ = 0;
  std::uint32_t most_ = 0;      // candidates that the blob declares, and there is room for
  std::uint32_t unseen_ = 0;    // points that it declares for a query and that were not met yet
  std::uint32_t untested_ = 0;  // likewise, for a slab
  std::uint32_t corner_ = 0;    // where the gather goes on: in the leaf of this corner,
  std::uint32_t next_ = 0;      // with this point
  std::uint32_t end_ = 0;       // behind its last
  bool in_leaf_ = false;        // next_ and end_ hold
  Vec3 centre_{};
  float slack_squared_ = 0.0F;  // m^2
  bool valid_ = false;
  bool begun_ = false;
  bool complete_ = true;
};

/// What the fitted sphere says at one position.
struct SurfaceFit {
  bool supported = false;  ///< points around; else distance, normal, strength are zero
  float distance = 0.0F;   ///< m, signed, along the normals
  Vec3 normal{};           ///< unit length
  /// 1 where points lie all around, falling smoothly to 0 where the surface ends: the distance of
  /// the weighted centroid from the foot of the query, measured in support radii.
  float strength = 0.0F;
  /// Points on enough sides to say where the surface is. Else, where a surface ends or has a hole,
  /// the fit still tells a proxy that is in contact where to go on.
  [[nodiscard]] bool firm() const { return supported && strength > 0.0F; }
  /// Share of the weight around that faces the reference.
  float facing = 1.0F;
  std::uint32_t passes = 1;  ///< that it took
};

/// The candidate nearest to `x` within `radius`; null: none. Cost: one pass over the set.
[[nodiscard]] const Candidate* nearest_candidate(const CandidateSet& set, Vec3 x, float radius);

/// The fit at `x`, weights (1 - d^2/radius^2)^4, of the candidates whose normal has a positive
/// component along `reference`: that keeps the two sides of a thin plate apart.
/// Where two faces meet in a sharp edge or corner each gets a fit of its own, and the surface is
/// where they intersect: the edge stays sharp, and the faces beside it true.
/// Cost: one pass over the set, two at a crease, at most kMaxCandidates points each, then about 60
/// operations a fit.
[[nodiscard]] SurfaceFit fit_surface(const CandidateSet& set, Vec3 x, float radius, Vec3 reference);

/// A position brought onto the surface.
struct SurfaceProjection {
  bool supported = false;
  float signed_distance = 0.0F;  ///< m, of the position; positive on the side of the normals
  Vec3 normal{};                 ///< unit length
  Vec3 point{};                  ///< m, on the surface
};

/// Projects `x` with two Newton steps along the fit; the reference normal is that of the nearest
/// point in the support. Cost: two gathers and two fits. `scratch` may hold anything.
[[nodiscard]] SurfaceProjection project_to_surface(const BlobView& view, Vec3 x,
                                                   CandidateSet& scratch);

/// The same with a scratch on the stack (about 4 KiB).
[[nodiscard]] SurfaceProjection project_to_surface(const BlobView& view, Vec3 x);

/// Can surface mode run on this model, and if not, why?
enum class SurfaceSupport : std::uint8_t {
  kOk = 0,
  kEmpty,          ///< no model
  kNoReach,        ///< the blob was built without the guarantee reach > support radius > 0
  kTooManyPoints,  ///< a ball may hold more than kMaxCandidates points, or a leaf 256 or more
};
[[nodiscard]] SurfaceSupport surface_support(const BlobView& view);

}  // namespace tactree::core
