#pragma once
// One pass over the candidates sums the points in the support: of one face, or of up to three.

#include "contact/face_fits.hpp"

namespace tactree::core {

/// The points in the support, relative to one face.
struct Surroundings {
  Moments face;               // points that face the reference
  float averted;              // weight of the others
  std::uint32_t aligned;      // points of the reference's own face
  const Candidate* crease;    // nearest point of another face; null: none, here and below
  const Candidate* mild;      // nearest point of a face at less than 47 degrees
  const Candidate* opposite;  // nearest point of an opposite face
};
[[nodiscard]] Surroundings look_around(const CandidateSet& points, Vec3 x, float radius,
                                       Vec3 reference);

/// The points in the support, each with the face whose normal is closest to its own. A row holds
/// those that face the reference from its front, those averted from its end; the points of no face
/// that face the reference are at the end of the first row.
struct Division {
  static constexpr std::uint8_t kBetween = 0x80;  // flag of an index: the point is between faces
  std::uint8_t point[kMaxFaces][kMaxCandidates];
  std::uint32_t facing[kMaxFaces];
  std::uint32_t averted[kMaxFaces];
  const Candidate* stray;     // nearest point of no face; null: none, here and below
  const Candidate* opposite;  // the same, opposite to the first one
};
static_assert(kMaxCandidates <= Division::kBetween);

/// Divides the points among the faces of the seeds.
void divide(const CandidateSet& points, Vec3 x, float radius, const Seeds& seeds,
            Division& division);

struct DividedSums {
  Faces faces;
  Moments facing;  // of all points that face the reference
};
[[nodiscard]] DividedSums sum_faces(const CandidateSet& points, Vec3 x, float radius,
                                    const Division& division);

}  // namespace tactree::core
