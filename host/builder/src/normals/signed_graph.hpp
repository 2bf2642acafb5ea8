#pragma once
// The graph of near neighbours of a cloud with unsigned normals, and the relative sign of each
// edge.

#include <cstdint>
#include <span>
#include <vector>

#include "geometry/z_order.hpp"

namespace tactree::builder {

/// weight > 0: the normals agree; < 0: one of them must be reversed. |weight| <= 1: the certainty.
struct SignedLink {
  std::uint32_t to;
  float weight;
};

/// Links between numbered nodes, in a row for each node, one row behind the other.
struct SignedGraph {
  std::vector<std::uint32_t> first = {0};  ///< link of each row, and the number of links
  std::vector<SignedLink> links;

  [[nodiscard]] std::uint32_t size() const { return static_cast<std::uint32_t>(first.size() - 1); }
  [[nodiscard]] std::span<const SignedLink> of(std::uint32_t node) const {
    return std::span(links).subspan(first[node], first[node + 1] - first[node]);
  }
};

/// Links each point with its ten nearest neighbours within three spacings. If both of two points
/// are among the nearest of the other, the link is in the row of the lower one only.
/// Two normals are compared after mirroring one in the plane midway between the points, which is
/// exact on a sphere and carries signs around edges. A link that passes through the body instead
/// of along its surface is left out. Deterministic. Cost: about 4 us per point and core.
[[nodiscard]] SignedGraph signed_graph(const ZOrderedCloud& points,
                                       std::span<const Eigen::Vector3f> normals, double spacing);

/// The same links, each in the row of its other end; the links of a row ascend.
[[nodiscard]] SignedGraph transposed(const SignedGraph& graph);

/// Patches of points whose relative signs are certain.
struct Patches {
  std::vector<std::uint32_t> of_point;  ///< number of the patch, ascending by lowest point
  std::vector<std::uint8_t> reversed;   ///< per point: 1 if its normal opposes that of the patch
  std::uint32_t count = 0;
};

/// Joins points along the most certain edges first, down to `least_weight`, unless their `evidence`
/// (per point, 1: its normal points outside) contradicts it.
[[nodiscard]] Patches certain_patches(const SignedGraph& graph, std::span<const float> evidence,
                                      float least_weight);

}  // namespace tactree::builder
