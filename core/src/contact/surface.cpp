// The fit of an algebraic sphere, or of two at a crease, and the projection onto it.
// Loop and memory annotations: docs/BOUND.md.
// memory: RAM

#include "tactree/core/surface.hpp"

namespace tactree::core {
namespace {

// Offset of the centroid, in support radii, from which the strength falls and at which it is 0.
// On a regular sheet it is below 0.1 inside and 0.24 on the boundary.
constexpr float kFadeBegins = 0.6F;
constexpr float kFadeEnds = 0.95F;

// Below this share of A the points nearly coincide: fit a plane.
constexpr float kFlatShare = 1e-3F;

// Two faces meet in a crease if their normals differ by 60 to 120 degrees. A larger angle is the
// other side of a plate, which is ignored.
constexpr float kCreaseCosine = 0.5F;
// A point belongs to a face if its normal is within 30 degrees of the face's.
constexpr float kFaceCosine = 0.87F;
// Largest share of points between two faces; more, and the edge is round, not sharp.
constexpr float kRoundShare = 0.25F;
// A crease requires each face's centroid at this distance, in support radii, from the other face's
// plane, and this many points on the other face: a stray normal within a face makes no crease.
constexpr float kApart = 0.04F;
constexpr std::uint32_t kFacePoints = 3;

/// The weighted sums of a fit; q is relative to the query position.
struct Moments {
  float w = 0.0F;
  Vec3 p{};
  Vec3 n{};
  float a = 0.0F;
  float b = 0.0F;

  void add(Vec3 q, float qq, Vec3 normal, float weight) {
    w += weight;
    p += weight * q;
    n += weight * normal;
    a += weight * qq;
    b += weight * dot(q, normal);
  }
};

/// Weight of a point in the support at squared distance qq.
float weight_of(float qq, float inverse_squared) {
  const float u = 1.0F - qq * inverse_squared;
  const float u2 = u * u;
  return u2 * u2;
}

/// The points in the support, relative to one face.
struct Surroundings {
  Moments face{};                     // points that face the reference
  float averted = 0.0F;               // weight of the others
  const Candidate* crease = nullptr;  // nearest point of another face
};

// The sums are locals, not members of the result: a compiler keeps locals in registers.
[[gnu::noinline]] Surroundings look_around(const CandidateSet& set, Vec3 x, float radius,
                                           Vec3 reference) {
  const float radius_squared = radius * radius;
  const float inverse_squared = 1.0F / radius_squared;
  Moments face;
  float averted = 0.0F;
  float nearest = radius_squared;
  const Candidate* crease = nullptr;
  for (const Candidate& candidate : set) {  // bound: points_per_ball_max
    const Vec3 q = candidate.position - x;
    const float qq = length_squared(q);
    if (!(qq < radius_squared)) {
      continue;
    }
    const float weight = weight_of(qq, inverse_squared);
    const float cosine = dot(candidate.normal, reference);
    if (cosine < kCreaseCosine) {
      if (cosine > -kCreaseCosine && qq < nearest) {
        nearest = qq;
        crease = &candidate;
      }
      if (!(cosine > 0.0F)) {
        averted += weight;
        continue;
      }
    }
    face.add(q, qq, candidate.normal, weight);
  }
  return {face, averted, crease};
}

/// The points around a crease, each with the face whose normal is closer to its own.
struct Faces {
  Moments own{};
  Moments other{};
  std::uint32_t others = 0;
  float between = 0.0F;  // weight of the points that belong to neither
};

[[gnu::noinline]] Faces divide(const CandidateSet& set, Vec3 x, float radius, Vec3 own,
                               Vec3 other) {
  const float radius_squared = radius * radius;
  const float inverse_squared = 1.0F / radius_squared;
  Moments own_face;  // locals, as above
  Moments other_face;
  std::uint32_t others = 0;
  float between = 0.0F;
  for (const Candidate& candidate : set) {  // bound: points_per_ball_max
    const Vec3 q = candidate.position - x;
    const float qq = length_squared(q);
    if (!(qq < radius_squared)) {
      continue;
    }
    const float weight = weight_of(qq, inverse_squared);
    const float to_own = dot(candidate.normal, own);
    const float to_other = dot(candidate.normal, other);
    const bool is_own = to_own >= to_other;
    const float closer = is_own ? to_own : to_other;
    if (!(closer > 0.0F)) {
      continue;
    }
    if (is_own) {
      own_face.add(q, qq, candidate.normal, weight);
    } else {
      other_face.add(q, qq, candidate.normal, weight);
      ++others;
    }
    if (closer < kFaceCosine) {
      between += weight;
    }
  }
  return {own_face, other_face, others, between};
}

/// 1 below kFadeBegins, 0 from kFadeEnds on, smooth between.
float strength_of(float offset) {
  if (!(offset > kFadeBegins)) {
    return 1.0F;
  }
  if (!(offset < kFadeEnds)) {
    return 0.0F;
  }
  const float s = (kFadeEnds - offset) * (1.0F / (kFadeEnds - kFadeBegins));
  return s * s * (3.0F - 2.0F * s);
}

/// The algebraic sphere through weighted points and normals.
SurfaceFit solve(const Moments& m, float radius) {
  SurfaceFit fit;  // memory: flash
  if (!(m.w > 0.0F)) {
    return fit;
  }
  const float inverse_w = 1.0F / m.w;
  const float spread = m.a - dot(m.p, m.p) * inverse_w;
  float uq = 0.0F;
  if (spread > kFlatShare * m.a) {
    uq = 0.5F * (m.b - dot(m.p, m.n) * inverse_w) / spread;
  }
  const Vec3 l = inverse_w * (m.n - (2.0F * uq) * m.p);
  const float uc = -inverse_w * (dot(l, m.p) + uq * m.a);
  const float ll = length_squared(l);
  if (!(ll > 1e-12F) || !is_finite(ll) || !is_finite(uc)) {
    return fit;
  }
  const float l_length = square_root(ll);
  const float root = ll - 4.0F * uc * uq;
  const float distance = 2.0F * uc / (l_length + square_root(root > 0.0F ? root : 0.0F));
  const Vec3 normal = (1.0F / l_length) * l;

  const Vec3 centroid = inverse_w * m.p;
  const Vec3 along = centroid - dot(centroid, normal) * normal;
  const float strength = strength_of(length(along) / radius);
  if (!is_finite(distance) || !is_finite(strength)) {
    return fit;
  }
  return {true, distance, normal, strength, 1.0F};
}

/// The surface at a crease. The inside of a convex edge is the intersection of the insides of both
/// faces, that of a concave edge their union. The smooth fit stays if the points do not form two
/// faces.
SurfaceFit combine(const SurfaceFit& smooth, const Faces& faces, float radius) {
  const float lesser = faces.own.w < faces.other.w ? faces.own.w : faces.other.w;
  if (faces.others < kFacePoints || faces.between > kRoundShare * lesser) {
    return smooth;
  }
  const SurfaceFit own = solve(faces.own, radius);
  const SurfaceFit other = solve(faces.other, radius);
  if (!own.firm() || !other.firm()) {
    return other.firm() ? other : smooth;  // around the corner, or along the boundary of a face
  }
  const Vec3 own_to_other =
      (1.0F / faces.other.w) * faces.other.p - (1.0F / faces.own.w) * faces.own.p;
  const float other_above_own = dot(own_to_other, own.normal);
  const float own_above_other = -dot(own_to_other, other.normal);
  const float apart = kApart * radius;
  if (other_above_own < -apart && own_above_other < -apart) {
    return own.distance >= other.distance ? own : other;
  }
  if (other_above_own > apart && own_above_other > apart) {
    return own.distance <= other.distance ? own : other;
  }
  return smooth;
}

}  // namespace

SurfaceFit fit_surface(const CandidateSet& set, Vec3 x, float radius, Vec3 reference) {
  // at most: passes per Scene::update together passes
  const Surroundings around = look_around(set, x, radius, reference);
  SurfaceFit fit = solve(around.face, radius);
  if (around.crease != nullptr) {
    // at most: passes per Scene::update together passes
    const Faces faces = divide(set, x, radius, reference, around.crease->normal);
    fit = combine(fit, faces, radius);
    fit.passes = 2;
  }
  const float all = around.face.w + around.averted;
  fit.facing = all > 0.0F ? around.face.w / all : 1.0F;
  return fit;
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
  const SurfaceFit first = fit_surface(scratch, x, radius, nearest->normal);
  if (!first.firm()) {
    return result;
  }
  const Vec3 near = x - first.distance * first.normal;
  scratch.cover(view, near);
  const SurfaceFit second = fit_surface(scratch, near, radius, first.normal);
  if (!second.firm()) {
    return result;
  }
  result.supported = true;
  result.point = near - second.distance * second.normal;
  result.normal = second.normal;
  const float distance = length(x - result.point);
  result.signed_distance = first.distance < 0.0F ? -distance : distance;
  return result;
}

SurfaceProjection project_to_surface(const BlobView& view, Vec3 x) {
  CandidateSet scratch;
  return project_to_surface(view, x, scratch);
}

}  // namespace tactree::core
