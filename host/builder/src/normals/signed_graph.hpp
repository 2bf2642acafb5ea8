#pragma once
// The graph of near neighbours of a cloud with unsigned normals, and the relative sign of each
// edge.

#include <cstdint>
#include <span>
#include <vector>

#include "geometry/z_order.hpp"

namespace tactree::builder {

/// weight > 0: the normals agree; < 0: one of them must be reversed. |weight| <= 1: the certainty.
struct SignedEdge {
  std::uint32_t from;  ///< < to
  std::uint32_t to;
  float weight;
};

/// Returns the edges to the ten nearest neighbours within three spacings, ordered by (from, to).
/// Two normals are compared after mirroring one in the plane midway between the points, which is
/// exact on a sphere and carries signs around edges. An edge that passes through the body instead
/// of along its surface is left out. Deterministic. Cost: about 4 us per point and core.
[[nodiscard]] std::vector<SignedEdge> signed_graph(const ZOrderedCloud& points,
                                                   std::span<const Eigen::Vector3f> normals,
                                                   double spacing);

/// Patches of points whose relative signs are certain.
struct Patches {
  std::vector<std::uint32_t> of_point;  ///< number of the patch, ascending by lowest point
  std::vector<std::uint8_t> reversed;   ///< per point: 1 if its normal opposes that of the patch
  std::uint32_t count = 0;
};

/// Joins points along the most certain edges first, down to `least_weight`, unless their `evidence`
/// (per point, 1: its normal points outside) contradicts it.
[[nodiscard]] Patches certain_patches(const std::vector<SignedEdge>& edges,
                                      std::span<const float> evidence, float least_weight);

}  // namespace tactree::builder
