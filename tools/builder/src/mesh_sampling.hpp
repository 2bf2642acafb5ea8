#pragma once
// Points spread densely over the faces of a triangle mesh, to choose a model's points from.

#include <array>
#include <cstdint>
#include <vector>

#include "cloud.hpp"

namespace tactree::builder {

struct Mesh {
  std::vector<Eigen::Vector3d> positions;
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< indices into positions, all valid
  std::vector<std::uint8_t> materials;  ///< empty, or one per position, as in a Cloud
};

/// Mean distance of candidates, in spacings: 7 of them for each point that will be kept.
inline constexpr double kCandidateDistance = 0.37;

/// More would not fit into memory comfortably; a blob of this density would be 15 MB.
inline constexpr double kMostCandidates = 20e6;

/// Drops the triangles without area (told by their corners at the rounding of their coordinates),
/// and those with a corner for which keep[corner] is false (empty: all are kept).
/// Returns {degenerate, of dropped corners}.
std::array<std::uint64_t, 2> drop_faces(Mesh& mesh, const std::vector<bool>& keep);

[[nodiscard]] double area_of(const Mesh& mesh);

/// One point for every (kCandidateDistance * spacing)^2 of area on average, in a low-discrepancy
/// pattern that is a function of the triangle's number alone, with the normal that the corners'
/// order tells (counter-clockwise seen from outside). Each lies on its face but for rounding.
/// Throws std::runtime_error, with the count and a remedy, above kMostCandidates.
[[nodiscard]] Cloud sample_faces(const Mesh& mesh, double spacing);

}  // namespace tactree::builder
