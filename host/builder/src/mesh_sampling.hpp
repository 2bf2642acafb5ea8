#pragma once
// Dense sampling of a triangle mesh: the candidates for the points of a model.

#include <array>
#include <cstdint>
#include <vector>

#include "cloud.hpp"

namespace tactree::builder {

struct Mesh {
  std::vector<Eigen::Vector3d> positions;
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< indices into positions, all valid
  std::vector<std::uint8_t> materials;  ///< empty, or one per position, as in a Cloud
  std::vector<std::uint8_t> doubtful;   ///< empty, or one per triangle: 1 if its side is doubtful
};

/// Mean distance of candidates, in spacings: about 7 candidates per point of the model.
inline constexpr double kCandidateDistance = 0.37;

/// Limits memory; a blob of this density would have 15 MB.
inline constexpr double kMaxCandidates = 20e6;

/// Drops triangles whose area is within the rounding of their coordinates, and triangles with a
/// corner for which keep[corner] is false (empty: keep all).
/// Returns the counts {degenerate, with a dropped corner}.
std::array<std::uint64_t, 2> drop_faces(Mesh& mesh, const std::vector<bool>& keep);

[[nodiscard]] double area_of(const Mesh& mesh);

/// Samples one point per (kCandidateDistance * spacing)^2 of area on average, in a low-discrepancy
/// pattern that depends on the triangle's index only. Each point lies on its face, up to rounding;
/// its normal follows from the order of the corners (counter-clockwise seen from outside).
/// Throws std::runtime_error, with the count and a remedy, above kMaxCandidates.
[[nodiscard]] Cloud sample_faces(const Mesh& mesh, double spacing);

}  // namespace tactree::builder
