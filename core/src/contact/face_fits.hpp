#pragma once
// The faces that meet at a place: sums over the points of each, their fits, and what they are to
// each other.

#include <cstdint>

#include "tactree/core/contact/surface.hpp"

namespace tactree::core {

/// The weighted sums of a fit; q is relative to the query position.
struct Moments {
  float w;
  Vec3 p;
  Vec3 n;
  float a;
  float b;

  void add(Vec3 q, float qq, Vec3 normal, float weight) {
    w += weight;
    p += weight * q;
    n += weight * normal;
    a += weight * qq;
    b += weight * dot(q, normal);
  }
  friend Moments operator+(const Moments& c, const Moments& d) {
    return {c.w + d.w, c.p + d.p, c.n + d.n, c.a + d.a, c.b + d.b};
  }
};

/// The surface through the points of one face at the query position.
struct FaceFit {
  bool supported;
  float strength;
  float weight;  // of the points
  Plane plane;

  [[nodiscard]] bool firm() const { return supported && strength > 0.0F; }
};

/// The algebraic sphere through weighted points and normals.
[[nodiscard]] FaceFit fit_face(const Moments& sums, float radius);

/// The points of one of several faces: those whose normal is closest to the face's.
struct Face {
  Moments sums;
  std::uint32_t points;
  float between;  // weight of the points that lie between faces

  friend Face operator+(const Face& c, const Face& d) {
    return {c.sums + d.sums, c.points + d.points, c.between + d.between};
  }
};

struct Faces {
  Face of[kMaxFaces];  // those without a seed have no points
};

/// Normals by which the points are told apart; the reference first.
struct Seeds {
  Vec3 normal[kMaxFaces];
  std::uint32_t count;
};

/// The normals of two faces differ by at least 47 degrees; those of opposite faces by 120.
inline constexpr float kCreaseCosine = 0.68F;
inline constexpr float kOppositeCosine = -0.5F;
/// A crease requires each face's centroid at this distance, in support radii, from the other face's
/// plane: a stray normal within a face makes no crease.
inline constexpr float kApart = 0.04F;

/// Joins the faces of `seeds` to one surface, as seen from `side`; `near` become those that belong
/// to it, apart from its own. The inside of a convex edge is the intersection of the insides of its
/// faces: the surface is that of the face that is highest at the query. The inside of a concave
/// edge is their union: all of them hold a probe. False, and `result` as it was: the points do not
/// form several faces.
[[nodiscard]] bool join_faces(const Faces& faces, const Seeds& seeds, float radius, float side,
                              NearFaces& near, SurfaceFit& result);

}  // namespace tactree::core
