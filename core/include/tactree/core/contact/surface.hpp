#pragma once
// The surface between the points of a blob: an algebraic sphere fitted to the points around the
// query (APSS; Guennebaud and Gross, "Algebraic Point Set Surfaces", SIGGRAPH 2007).
//
// Interrupt safety: no shared state; a candidate set belongs to one context.

#include <cstdint>

#include "tactree/core/contact/candidates.hpp"
#include "tactree/core/contact/constraint_planes.hpp"
#include "tactree/core/model/blob.hpp"

namespace tactree::core {

/// The faces that meet near a position, except that of the reference. Kept from fit to fit.
struct NearFaces {
  Vec3 normal[kMaxFaces - 1]{};  ///< unit length, on the side of the points' normals
  std::uint32_t count = 0;
  /// Set by a smooth fit that finds the further face of a groove: normal of the nearest point of
  /// the reference's own face. The reference itself is the normal of a surface between the two,
  /// which would not divide the points of a groove of 145 to 150 degrees. Else zero.
  Vec3 own{};
};

/// The fitted surface near one query position.
struct SurfaceFit {
  bool supported = false;  ///< false: no usable points; normal and strength are zero
  bool complete = true;    ///< false: there are more points in the support than the blob declares
  float distance = 0.0F;   ///< m, signed, positive along the normals
  Vec3 normal{};           ///< unit length
  /// 1 inside the surface, falling smoothly to 0 at its boundary. Depends on the distance between
  /// the weighted centroid and the foot of the query, in support radii. Maximum over the faces that
  /// hold a probe.
  float strength = 0.0F;
  /// Sum of the weights of the face's points: a measure of how much of the face is near.
  float weight = 0.0F;
  /// True if enough points on all sides locate the surface. A fit that is supported but not firm,
  /// at a boundary or in a hole, still guides a proxy in contact.
  [[nodiscard]] bool firm() const { return strength > 0.0F; }
  /// If no face has the direction of the reference: normal of a face, for the next fit. Else zero.
  Vec3 next_reference{};
  float facing = 1.0F;       ///< fraction of the weight with normals that face the reference
  std::uint32_t passes = 1;  ///< cost of the fit: 1, or 2 with faces near
  /// Other faces at a crease, with distances and normals as above. First those that hold a probe
  /// together with this one, where the surface is concave, then those behind whose plane this face
  /// ends, where it is convex. `holding` and `ending` are their numbers.
  Plane also[kMaxFaces - 1]{};
  std::uint32_t holding = 0;
  std::uint32_t ending = 0;
  /// The back of a plate or of a sharp ridge, at its nearest point; zero normal if there is none.
  Plane back{};

  void set(const Plane& plane, float its_strength, float its_weight) {
    supported = true;
    distance = plane.distance;
    normal = plane.normal;
    strength = its_strength;
    weight = its_weight;
  }
};

/// Fits the surface at `x` to the candidates whose normal has a positive component along
/// `reference`, which separates the two sides of a thin plate. Weights: (1 - d^2/radius^2)^4.
/// At a sharp edge or vertex each face is fitted separately: up to three faces whose normals differ
/// by 47 degrees or more, and opposite walls of a gap. `side` is 1 for the side of the normals, -1
/// for the other side. Where the faces are convex as seen from `side`, the surface is that of the
/// face in front; where they are concave, all of them hold a probe. `near`: on entry, the faces of
/// the last fit nearby, or none; on return, those of this fit and a face that came near, which the
/// next fit separates. Cost: one pass over the set, at most kMaxCandidates points, and about 60
/// operations; with faces near, twice that.
[[nodiscard]] SurfaceFit fit_surface(const CandidateSet& points, Vec3 x, float radius,
                                     Vec3 reference, float side, NearFaces& near);

/// The planes that hold a probe on `side` at the position of a fit, beginning with that of the fit
/// itself. Normals and distances are positive towards that side.
[[nodiscard]] ConstraintPlanes holding_planes(const SurfaceFit& fit, float side);

/// holding_planes() and the planes of the `ending` faces, reversed: the surface is on the first
/// plane and in front of all others.
[[nodiscard]] ConstraintPlanes landing_planes(const SurfaceFit& fit, float side);

/// A position projected onto the surface.
struct SurfaceProjection {
  bool supported = false;
  float signed_distance = 0.0F;  ///< m, of the position; positive on the side of the normals
  Vec3 normal{};                 ///< unit length
  Vec3 point{};                  ///< m, on the surface
};

/// Projects `x` with two Newton steps; the first reference normal is that of the nearest point in
/// the support. Inside a concave edge or vertex, returns the nearest position in front of all its
/// faces. The result is not supported if the model has no surface near `x`, `x` is not finite, or
/// surface_support() is not kOk. Cost: two gathers and up to six fits. The initial content of
/// `scratch` is irrelevant.
[[nodiscard]] SurfaceProjection project_to_surface(const BlobView& view, Vec3 x,
                                                   CandidateSet& scratch);

/// Overload with the scratch on the stack (about 4 KiB).
[[nodiscard]] SurfaceProjection project_to_surface(const BlobView& view, Vec3 x);

/// kOk, or the reason why a model has no surface.
enum class SurfaceSupport : std::uint8_t {
  kOk = 0,
  kEmpty,          ///< no model
  kNoReach,        ///< the blob was built without the guarantee reach > support radius > 0
  kTooManyPoints,  ///< a ball may hold more than kMaxCandidates points, or a leaf 256 or more
};
[[nodiscard]] SurfaceSupport surface_support(const BlobView& view);

}  // namespace tactree::core
