// The fit at one position, and the projection onto the surface.
// Loop and memory annotations: docs/BOUND.md.
// memory: RAM

#include "tactree/core/contact/surface.hpp"

#include "contact/face_fits.hpp"
#include "contact/passes.hpp"

namespace tactree::core {
namespace {

// If no normal is within 12 degrees of the reference, the reference lies between two faces, both
// too close to it to look like another one: in a groove of 150 degrees, 15 degrees from both.
constexpr float kBetweenFaces = 0.977F;

Plane seen_from(float side, const Plane& plane) {
  return {side * plane.normal, side * plane.distance};
}

/// Adds a new face, which the next fit separates. If there is no room, it replaces a `holding` face
/// that is further away.
void admit(const SurfaceFit& fit, float side, Vec3 x, const Candidate& stray, NearFaces& near) {
  if (near.count < kMaxFaces - 1U) {
    near.normal[near.count++] = stray.normal;
    return;
  }
  const float distance = length(stray.position - x);
  for (std::uint32_t i = 0; i < fit.holding; ++i) {  // bound: kMaxFaces
    if (side * fit.also[i].distance > distance) {
      near.normal[i] = stray.normal;
      return;
    }
  }
}

void set_to(SurfaceFit& result, const FaceFit& fit) {
  result.supported = fit.supported;
  result.distance = fit.plane.distance;
  result.normal = fit.plane.normal;
  result.strength = fit.strength;
  result.weight = fit.weight;
}

/// The nearest point of a further face: of a crease, otherwise of an opposite wall ahead. An
/// opposite face that is not ahead is stored as the back of this one.
const Candidate* nearest_other(const Candidate* crease, const Candidate* opposite, Vec3 x,
                               float radius, float side, SurfaceFit& fit) {
  if (opposite == nullptr) {
    return crease;
  }
  const Vec3 q = opposite->position - x;
  if (side * (dot(q, fit.normal) + fit.distance) > kApart * radius) {
    return crease != nullptr ? crease : opposite;
  }
  fit.back = {opposite->normal, -dot(opposite->normal, q)};
  return crease;
}

/// True if each point is in front of the plane of the other by more than `apart`.
bool is_concave(const Candidate& a, const Candidate& b, float side, float apart) {
  const Vec3 a_to_b = b.position - a.position;
  return side * dot(a_to_b, a.normal) > apart && -side * dot(a_to_b, b.normal) > apart;
}

/// The fit at a crease that the last fit has found.
[[gnu::noinline]] void fit_faces(const CandidateSet& points, Vec3 x, float radius,
                                 const Seeds& seeds, float side, NearFaces& near,
                                 SurfaceFit& result) {
  Division division;
  divide(points, x, radius, seeds, division);
  const DividedSums sums = sum_faces(points, x, radius, seeds, division);
  result.passes = 2;
  result.complete = division.complete;
  const bool joined = join_faces(sums.faces, seeds, radius, side, near, result);
  if (!joined) {
    set_to(result, fit_face(sums.facing.sums, 1.0F / radius));
  }
  const Candidate* const other =
      nearest_other(division.stray, division.opposite, x, radius, side, result);
  if (joined && other != nullptr) {
    admit(result, side, x, *other, near);
  }
}

/// The fit where the last one was smooth. A crease that comes near is left to the next fit.
[[gnu::noinline]] void fit_smooth(const CandidateSet& points, Vec3 x, float radius, Vec3 reference,
                                  float side, NearFaces& near, SurfaceFit& result) {
  const Surroundings around = look_around(points, x, radius, reference);
  set_to(result, fit_face(around.face, 1.0F / radius));
  result.complete = around.complete;
  const float all = around.face.w + around.averted;
  result.facing = all > 0.0F ? around.face.w / all : 1.0F;
  const Candidate* const crease = around.crease != nullptr ? around.crease : around.mild;
  const Candidate* const other = nearest_other(crease, around.opposite, x, radius, side, result);
  if (other != nullptr) {
    // If several faces came near at once, the smooth surface lies between them.
    if (around.own == nullptr) {
      result.next_reference = other->normal;
    } else {
      near.own =
          is_concave(*around.own, *other, side, kApart * radius) ? around.own->normal : Vec3{};
      near.normal[near.count++] = other->normal;
    }
  } else if (around.own != nullptr && around.closest < kBetweenFaces) {
    result.next_reference = around.own->normal;
  }
}

}  // namespace

SurfaceFit fit_surface(const CandidateSet& points, Vec3 x, float radius, Vec3 reference, float side,
                       NearFaces& near) {
  SurfaceFit result;  // memory: flash
  if (near.count != 0U) {
    const Vec3 first = near.own != Vec3{} ? near.own : reference;
    const Seeds seeds{{first, near.normal[0], near.normal[1]}, 1U + near.count};
    near.own = {};
    // at most: passes per Scene::update together passes as 2
    fit_faces(points, x, radius, seeds, side, near, result);
  } else {
    // at most: passes per Scene::update together passes
    fit_smooth(points, x, radius, reference, side, near, result);
  }
  return result;
}

ConstraintPlanes holding_planes(const SurfaceFit& fit, float side) {
  return {{{side * fit.normal, side * fit.distance},
           fit.holding > 0U ? seen_from(side, fit.also[0]) : Plane{},
           fit.holding > 1U ? seen_from(side, fit.also[1]) : Plane{}},
          1U + fit.holding};
}

ConstraintPlanes landing_planes(const SurfaceFit& fit, float side) {
  const std::uint32_t count = fit.holding + fit.ending;
  return {{{side * fit.normal, side * fit.distance},
           count > 0U ? seen_from(fit.holding > 0U ? side : -side, fit.also[0]) : Plane{},
           count > 1U ? seen_from(fit.holding > 1U ? side : -side, fit.also[1]) : Plane{}},
          1U + count};
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

namespace {

/// Fits until no further face is found; each fit finds at most one.
SurfaceFit fit_all_faces(const CandidateSet& points, Vec3 x, float radius, Vec3 reference,
                         NearFaces& faces) {
  SurfaceFit fit = fit_surface(points, x, radius, reference, 1.0F, faces);
  for (std::uint32_t i = 1; i < kMaxFaces && faces.count >= i; ++i) {  // bound: kMaxFaces
    // The normal of a smooth fit lies between those of the faces and would not separate them.
    const Vec3 next = fit.holding + fit.ending != 0U ? fit.normal : reference;
    fit = fit_surface(points, x, radius, next, 1.0F, faces);
  }
  return fit;
}

}  // namespace

SurfaceProjection project_to_surface(const BlobView& view, Vec3 x, CandidateSet& scratch) {
  SurfaceProjection result;
  if (surface_support(view) != SurfaceSupport::kOk || !is_finite(x)) {
    return result;
  }
  const float radius = view.support_radius_m();
  scratch.clear();
  scratch.cover(view, x);
  const Candidate* const nearest = nearest_candidate(scratch, x, radius);
  if (nearest == nullptr) {
    return result;
  }
  NearFaces faces;
  const SurfaceFit first = fit_all_faces(scratch, x, radius, nearest->normal, faces);
  if (!first.firm()) {
    return result;
  }
  const Vec3 near = x - first.distance * first.normal;
  scratch.cover(view, near);
  const SurfaceFit second = fit_all_faces(scratch, near, radius, first.normal, faces);
  if (!second.firm()) {
    return result;
  }
  result.supported = true;
  result.point = near + shortest_move(landing_planes(second, 1.0F), true).step;
  result.normal = second.normal;
  if (second.holding != 0U && first.distance < 0.0F) {
    ConstraintPlanes planes = holding_planes(second, 1.0F);
    planes.step_by(x - near);
    result.point = x + shortest_move(planes, false).step;
  }
  const float distance = length(x - result.point);
  result.signed_distance = first.distance < 0.0F ? -distance : distance;
  return result;
}

SurfaceProjection project_to_surface(const BlobView& view, Vec3 x) {
  CandidateSet scratch;
  return project_to_surface(view, x, scratch);
}

}  // namespace tactree::core
