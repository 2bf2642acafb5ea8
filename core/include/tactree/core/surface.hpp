#pragma once
// The surface between the points of a blob: an algebraic sphere fitted to the points around the
// query (APSS; Guennebaud and Gross, "Algebraic Point Set Surfaces", SIGGRAPH 2007).
//
// Interrupt safety: no shared state; a candidate set belongs to one context.

#include <cstdint>

#include "tactree/core/blob.hpp"
#include "tactree/core/candidates.hpp"

namespace tactree::core {

/// The fitted surface near one query position.
struct SurfaceFit {
  bool supported = false;  ///< false: no usable points; distance, normal and strength are zero
  float distance = 0.0F;   ///< m, signed, positive along the normals
  Vec3 normal{};           ///< unit length
  /// 1 inside the surface, falling smoothly to 0 on its boundary; from the distance between the
  /// weighted centroid and the foot of the query, in support radii.
  float strength = 0.0F;
  /// Enough points on all sides to locate the surface. A fit that is supported but not firm, on a
  /// boundary or in a hole, still guides a proxy in contact.
  [[nodiscard]] bool firm() const { return supported && strength > 0.0F; }
  float facing = 1.0F;       ///< share of the weight whose normals face the reference
  std::uint32_t passes = 1;  ///< over the set: 1, or 2 at a crease
};

/// Fits the surface at `x` to the candidates whose normal has a positive component along
/// `reference`, which separates the two sides of a thin plate. Weights: (1 - d^2/radius^2)^4.
/// At a sharp edge or corner each face gets its own fit, and the surface is their intersection.
/// Cost: one pass over the set, two at a crease, at most kMaxCandidates points each, and about 60
/// operations per fit.
[[nodiscard]] SurfaceFit fit_surface(const CandidateSet& set, Vec3 x, float radius, Vec3 reference);

/// A position projected onto the surface.
struct SurfaceProjection {
  bool supported = false;
  float signed_distance = 0.0F;  ///< m, of the position; positive on the side of the normals
  Vec3 normal{};                 ///< unit length
  Vec3 point{};                  ///< m, on the surface
};

/// Projects `x` with two Newton steps; the first reference normal is that of the nearest point in
/// the support. Not supported: the model has no surface near `x`, `x` is not finite, or
/// surface_support() is not kOk. Cost: two gathers and two fits. `scratch` may hold anything.
[[nodiscard]] SurfaceProjection project_to_surface(const BlobView& view, Vec3 x,
                                                   CandidateSet& scratch);

/// The same with a scratch on the stack (about 4 KiB).
[[nodiscard]] SurfaceProjection project_to_surface(const BlobView& view, Vec3 x);

/// Whether a model has a surface, or the reason why not.
enum class SurfaceSupport : std::uint8_t {
  kOk = 0,
  kEmpty,          ///< no model
  kNoReach,        ///< the blob was built without the guarantee reach > support radius > 0
  kTooManyPoints,  ///< a ball may hold more than kMaxCandidates points, or a leaf 256 or more
};
[[nodiscard]] SurfaceSupport surface_support(const BlobView& view);

}  // namespace tactree::core
