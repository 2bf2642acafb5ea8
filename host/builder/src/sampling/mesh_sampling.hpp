#pragma once
// Dense sampling of a triangle mesh: the candidates for the points of a model.

#include "geometry/cloud.hpp"
#include "geometry/mesh.hpp"

namespace tactree::builder {

/// Mean distance of candidates, in spacings: about 7 candidates per point of the model.
inline constexpr double kCandidateDistance = 0.37;

/// Limits the memory; a blob of this density would have 15 MB.
inline constexpr double kMaxCandidates = 20e6;

/// Samples one point per (kCandidateDistance * spacing)^2 of area on average, in a low-discrepancy
/// pattern that depends only on the index of the triangle. Each point lies on its face, up to
/// rounding; its normal follows from the order of the vertices (counter-clockwise seen from
/// outside). Throws std::runtime_error, with the count and a hint, above kMaxCandidates.
[[nodiscard]] Cloud sample_faces(const Mesh& mesh, double spacing);

}  // namespace tactree::builder
