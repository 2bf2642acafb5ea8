// The fit of an algebraic sphere, and the relations of the faces at a crease.
// Loop and memory annotations: docs/BOUND.md.
// memory: RAM

#include "contact/face_fits.hpp"

namespace tactree::core {
namespace {

// Offset of the centroid, in support radii, at which the strength begins to fall and at which it is
// 0. On a regular sheet it is below 0.1 inside and 0.24 on the boundary, so that the force fades
// from 0.51 to 0.94 support radii beyond the boundary. With a smaller kFadeBegins the force would
// also fade where points are sparse. At kFadeEnds the weights are about 1e-4; closer to 1 they
// would vanish before the force does.
constexpr float kFadeBegins = 0.6F;
constexpr float kFadeEnds = 0.95F;

// Spread of the points about their centroid, relative to that about the query. From kCurvedFrom on,
// the surface has the curvature of the points; at kFlatBelow and below it is a plane, between them
// the curvature fades. A query beyond an edge is far from the few points that are left of a face,
// and the errors of their curvature are magnified: with the curvature kept down to 0.001, the force
// jumped by up to 1.9 N beyond the top of ridges of 30 to 45 degrees.
constexpr float kFlatBelow = 0.05F;
constexpr float kCurvedFrom = 0.2F;

// Maximum weight of the points between two faces, relative to the weight of the lesser face. Above
// it the edge is round, not sharp: at a right angle from a fillet of 0.18 support radii on (arc of
// its points between the faces, r pi / 6, against 0.39 R for the points of one face).
constexpr float kRoundShare = 0.25F;

// Minimum number of points of a further face: one or two stray normals are not a face. At the
// corner of a box a face has about five points (a quarter of a support of 2.5 spacings).
constexpr std::uint32_t kFacePoints = 3;

// Faces whose normals differ by less than kCreaseCosine are separated only if they are concave and
// flat: the smooth surface between them would lie above the crease. kFlat is the minimum squared
// length of the mean normal of a flat face: normals that deviate by less than 1.3 degrees rms. With
// a larger deviation, the bends and the noise of a scan would be divided into faces.
constexpr float kFlat = 0.9995F;

constexpr FaceFit kUnsupported = {false, 0.0F, 0.0F, {}};

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

bool is_flat(const Moments& sums) { return length_squared(sums.n) > kFlat * sums.w * sums.w; }

/// True if few points lie between the faces.
bool is_sharp(const Face& a, const Face& b) {
  const float lesser = a.sums.w < b.sums.w ? a.sums.w : b.sums.w;
  return a.between + b.between <= kRoundShare * lesser;
}

enum class Relation : std::uint8_t { kNone, kConvex, kConcave };

/// Two faces are concave if the centroid of each is in front of the other's plane, convex if it is
/// behind.
Relation relation_of(const Face& a, const FaceFit& a_fit, const Face& b, const FaceFit& b_fit,
                     float side, float apart) {
  const Vec3 a_to_b = (1.0F / b.sums.w) * b.sums.p - (1.0F / a.sums.w) * a.sums.p;
  const float b_above_a = side * dot(a_to_b, a_fit.plane.normal);
  const float a_above_b = -side * dot(a_to_b, b_fit.plane.normal);
  if (b_above_a < -apart && a_above_b < -apart) {
    return Relation::kConvex;
  }
  return b_above_a > apart && a_above_b > apart ? Relation::kConcave : Relation::kNone;
}

/// Relation of a face to the first one; kNone for the other side of a plate.
[[gnu::noinline]] Relation relation_to_first(const Face& first, const FaceFit& first_fit,
                                             const Face& face, const FaceFit& fit, float side,
                                             float apart) {
  if (!fit.firm() || face.points < kFacePoints || !is_sharp(first, face)) {
    return Relation::kNone;
  }
  const Relation relation = relation_of(first, first_fit, face, fit, side, apart);
  const float cosine = dot(first_fit.plane.normal, fit.plane.normal);
  const bool is_back = cosine < kOppositeCosine && relation == Relation::kConvex;
  const bool is_mild = cosine > kCreaseCosine;
  const bool is_soft =
      is_mild && (relation == Relation::kConvex || !is_flat(first.sums) || !is_flat(face.sums));
  return is_back || is_soft ? Relation::kNone : relation;
}

}  // namespace

[[gnu::noinline]] FaceFit fit_face(const Moments& m, float inverse_radius) {
  if (!(m.w > 0.0F)) {
    return kUnsupported;  // memory: flash
  }
  const float inverse_w = 1.0F / m.w;
  const Vec3 centroid = inverse_w * m.p;
  const Vec3 mean_normal = inverse_w * m.n;
  const float mean_square = inverse_w * m.a;
  const float spread = mean_square - length_squared(centroid);
  const float above = spread - kFlatBelow * mean_square;
  const float band = (kCurvedFrom - kFlatBelow) * mean_square;
  float uq = 0.0F;
  if (above > 0.0F) {
    float dividend = 0.5F * (inverse_w * m.b - dot(centroid, mean_normal));
    float divisor = spread;
    if (above < band) {
      dividend *= above;
      divisor *= band;
    }
    uq = dividend / divisor;
  }
  const Vec3 l = mean_normal - (2.0F * uq) * centroid;
  const float uc = -(dot(l, centroid) + uq * mean_square);
  const float ll = length_squared(l);
  if (!(ll > 1e-12F) || !is_finite(ll)) {
    return kUnsupported;  // memory: flash
  }
  const float l_length = square_root(ll);
  const float root = ll - 4.0F * uc * uq;
  const float distance = 2.0F * uc / (l_length + square_root(root > 0.0F ? root : 0.0F));
  const Vec3 normal = (1.0F / l_length) * l;

  const Vec3 along = centroid - dot(centroid, normal) * normal;
  const float strength = strength_of(length(along) * inverse_radius);
  if (!is_finite(distance)) {
    return kUnsupported;  // memory: flash
  }
  return {true, strength, m.w, {normal, distance}};
}

bool join_faces(const Faces& faces, const Seeds& seeds, float radius, float side, NearFaces& near,
                SurfaceFit& result) {
  const float apart = kApart * radius;
  const Face(&face)[kMaxFaces] = faces.of;
  const float inverse_radius = 1.0F / radius;
  const FaceFit fit[kMaxFaces] = {fit_face(face[0].sums, inverse_radius),
                                  fit_face(face[1].sums, inverse_radius),
                                  fit_face(face[2].sums, inverse_radius)};
  near.count = 0;
  if (!fit[0].firm()) {  // past an edge, or at the boundary of the first face
    for (std::uint32_t i = 1; i < kMaxFaces; ++i) {  // bound: kMaxFaces
      if (fit[i].firm() && face[i].points >= kFacePoints && is_sharp(face[0], face[i]) &&
          dot(fit[i].plane.normal, seeds.normal[0]) > kOppositeCosine) {
        result.set(fit[i].plane, fit[i].strength, fit[i].weight);
        return true;
      }
    }
    return false;
  }
  Relation relation[kMaxFaces] = {Relation::kNone,
                                  relation_to_first(face[0], fit[0], face[1], fit[1], side, apart),
                                  relation_to_first(face[0], fit[0], face[2], fit[2], side, apart)};
  std::uint32_t main = 0;
  for (std::uint32_t i = 1; i < kMaxFaces; ++i) {  // bound: kMaxFaces
    const bool is_higher = side * fit[i].plane.distance > side * fit[main].plane.distance;
    main = relation[i] == Relation::kConvex && is_higher ? i : main;
  }
  if (main != 0U) {  // relations of the others to that face
    const std::uint32_t third = kMaxFaces - main;
    relation[0] = relation_of(face[main], fit[main], face[0], fit[0], side, apart);
    if (relation[third] != Relation::kNone) {
      relation[third] = relation_of(face[main], fit[main], face[third], fit[third], side, apart);
    }
    relation[main] = Relation::kNone;
  }
  float strength = fit[main].strength;
  for (std::uint32_t i = 0; i < kMaxFaces; ++i) {  // bound: kMaxFaces
    if (relation[i] == Relation::kConcave) {
      result.also[near.count] = fit[i].plane;
      near.normal[near.count++] = fit[i].plane.normal;
      strength = fit[i].strength > strength ? fit[i].strength : strength;
    }
  }
  result.holding = near.count;
  for (std::uint32_t i = 0; i < kMaxFaces; ++i) {  // bound: kMaxFaces
    if (relation[i] == Relation::kConvex) {
      result.also[near.count] = fit[i].plane;
      near.normal[near.count++] = fit[i].plane.normal;
    }
  }
  result.ending = near.count - result.holding;
  if (near.count == 0U) {
    return false;
  }
  result.set(fit[main].plane, strength, fit[main].weight);
  return true;
}

}  // namespace tactree::core
