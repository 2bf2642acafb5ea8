#pragma once
// The faces that meet at a position: sums over the points of each, their fits, and the relations
// between them.

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
  float strength;  // 0 if not supported
  float weight;    // sum over the points
  Plane plane;

  [[nodiscard]] bool firm() const { return strength > 0.0F; }
};

/// The algebraic sphere through weighted points and normals. `inverse_radius`: of the support, 1/m.
[[nodiscard]] FaceFit fit_face(const Moments& sums, float inverse_radius);

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

/// Normals by which the points are divided among the faces; the reference first.
struct Seeds {
  Vec3 normal[kMaxFaces];
  std::uint32_t count;
};

/// The normals of two faces differ by at least 47 degrees, those of opposite faces by at least 117.
/// With 60 degrees, the proxy stays 85 to 130 um above the bottom of a groove of 120 degrees. With
/// 35 degrees, bends of scans are divided: the largest force step on a statue rose from 0.9 to 1.9
/// N. Convex faces that differ by more than 117 degrees are the two sides of a plate; with 120,
/// errors of the normals would decide what a ridge of 60 degrees is.
inline constexpr float kCreaseCosine = 0.68F;
inline constexpr float kOppositeCosine = -0.45F;
/// A crease requires that the centroid of each face has at least this distance, in support radii,
/// from the plane of the other face. A stray normal within a face then makes no crease. Between
/// faces whose normals differ by an angle a, it is 0.24 sin(a): 0.07 at 18 degrees, the smallest
/// angle of a crease. Noise of 5 % of the spacing is 0.02.
inline constexpr float kApart = 0.04F;

/// Combines the faces of `seeds` into one surface, as seen from `side`. `near` receives the normals
/// of the other faces that belong to it. The interior of a convex edge is the intersection of the
/// interiors of its faces: the surface is that of the face with the maximum height at the query.
/// The interior of a concave edge is their union: all faces hold a probe. Returns false and leaves
/// `result` unchanged if the points do not form several faces.
[[nodiscard]] bool join_faces(const Faces& faces, const Seeds& seeds, float radius, float side,
                              NearFaces& near, SurfaceFit& result);

}  // namespace tactree::core
