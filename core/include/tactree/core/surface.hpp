#pragma once
// The surface a hand feels between the points: an algebraic sphere fitted to the points around the
// query (APSS; Guennebaud and Gross, "Algebraic Point Set Surfaces", SIGGRAPH 2007).
//
// Interrupt safety of all that follows: no shared state; a set belongs to one context.

#include <cstdint>

#include "tactree/core/blob.hpp"

namespace tactree::core {

/// Decoded points one gather can hold. A blob whose points_per_ball_max is larger is not loaded.
inline constexpr std::uint32_t kMaxCandidates = 128;

inline constexpr std::uint32_t kNoCandidate = 0xFFFFFFFFU;

/// The decoded points around a centre, good for every query within the slack of that centre:
/// slack = reach_m - support_radius_m. A gather costs at most 8 leaves, points_per_query_max
/// points.
class CandidateSet {
 public:
  /// Forgets the last gather; needed whenever the blob changes.
  void clear() { valid_ = false; }

  /// Makes the set good for a query at `x`: gathers anew when x lies outside the slack, ahead of x
  /// in the direction it has moved.
  /// Precondition: the view is the one of the last gather, or clear() was called in between.
  void cover(const BlobView& view, Vec3 x);

  [[nodiscard]] std::uint32_t count() const { return count_; }
  /// False: the blob held more points than it declares, or than kMaxCandidates, and some were left
  /// out.
  [[nodiscard]] bool complete() const { return complete_; }
  [[nodiscard]] Vec3 position(std::uint32_t i) const { return positions_[i]; }
  [[nodiscard]] Vec3 normal(std::uint32_t i) const { return normals_[i]; }
  /// Number of the point in the blob.
  [[nodiscard]] std::uint32_t point(std::uint32_t i) const { return points_[i]; }

 private:
  void gather(const BlobView& view, Vec3 centre);
  void gather_leaf(const BlobView& view, const Leaf& leaf, float reach_squared);

  Vec3 positions_[kMaxCandidates];
  Vec3 normals_[kMaxCandidates];
  std::uint32_t points_[kMaxCandidates];
  std::uint32_t count_ = 0;
  std::uint32_t most_ = 0;    // candidates that the blob declares, and there is room for
  std::uint32_t unseen_ = 0;  // points of this gather that it declares and that were not tested yet
  Vec3 centre_{};
  bool valid_ = false;
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
};

/// Slot of the candidate nearest to `x` within `radius`; kNoCandidate: none.
[[nodiscard]] std::uint32_t nearest_candidate(const CandidateSet& set, Vec3 x, float radius);

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
  kNoReach,        ///< the blob was built without the guarantee reach >= support radius > 0
  kTooManyPoints,  ///< a ball may hold more than kMaxCandidates points
};
[[nodiscard]] SurfaceSupport surface_support(const BlobView& view);

}  // namespace tactree::core
