#pragma once
// Passes over the candidates that sum the points in the support: of one face, or of up to three.

#include "contact/face_fits.hpp"

namespace tactree::core {

/// Level of the points of a face: heights of its nearest point above the query.
struct Level {
  Vec3 normal;   // of the face
  float common;  // m, along that normal
  float own;     // m, along the normal of the point; NaN: any level
};

/// Level of the face with this normal at its nearest point; any level without one.
[[nodiscard]] Level level_of(const Candidate* nearest, Vec3 x, Vec3 normal);

/// The square of the support radius, m^2, and its inverse.
struct SupportSquare {
  float squared;
  float inverse;
};

/// Adds those of the indexed points that are at this level. `after` may be `before`.
void add_to_face(const CandidateSet& points, Vec3 x, SupportSquare radius,
                 const std::uint8_t* indices, std::uint32_t count, const Level& of_face,
                 const Face& before, Face& after);

/// The points in the support, relative to one face.
struct Surroundings {
  Moments face;               // points that face the reference
  bool complete;              // false: more points than the blob declares
  float averted;              // weight of the other points
  const Candidate* own;       // nearest point of the reference's own face; null: none
  float closest;              // cosine of the least angle between its normals and the reference
  const Candidate* crease;    // nearest point of another face; null: none, here and below
  const Candidate* mild;      // nearest point of a face at 18 to 47 degrees
  const Candidate* opposite;  // nearest point of an opposite face
};
[[nodiscard]] Surroundings look_around(const CandidateSet& points, Vec3 x, float radius,
                                       Vec3 reference);

/// The nearest of the offered points.
struct Nearest {
  float squared;           // m^2, distance of the point; initially that of the support
  const Candidate* point;  // null: none

  void offer(const Candidate& candidate, float its_squared) {
    if (its_squared < squared) {
      squared = its_squared;
      point = &candidate;
    }
  }
};

/// The points in the support, each with the face whose normal is closest to its own. A row holds
/// the points that face the reference from its front and the averted ones from its end. In the
/// first row, which has no averted points, the end holds the points that face the reference and
/// belong to no face.
struct Division {
  static constexpr std::uint8_t kBetween = 0x80;  // flag of an index: the point is between faces
  std::uint8_t point[kMaxFaces][kMaxCandidates];
  std::uint32_t facing[kMaxFaces];
  std::uint32_t averted[kMaxFaces];
  bool complete;               // false: more points than the blob declares
  bool has_levels;             // few points lie between faces
  Nearest nearest[kMaxFaces];  // point of each face that is not between faces
  const Candidate* stray;      // nearest point at 47 degrees or more from all faces; null: none
  const Candidate* opposite;   // as above, but opposite to the first face
};
static_assert(kMaxCandidates <= Division::kBetween);

/// Divides the points among the faces of the seeds.
void divide(const CandidateSet& points, Vec3 x, float radius, const Seeds& seeds,
            Division& division);

struct DividedSums {
  Faces faces;
  Face facing;  // all points that face the reference
};
[[nodiscard]] DividedSums sum_faces(const CandidateSet& points, Vec3 x, float radius,
                                    const Seeds& seeds, const Division& division);

}  // namespace tactree::core
