#pragma once
// The connected components of an input, before its surface is known.

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "geometry/mesh.hpp"
#include "geometry/z_order.hpp"

namespace tactree::builder {

struct PieceRule {
  bool only_largest = false;
  std::uint64_t least_points = 0;
};

/// For each position the index of the lowest one with equal coordinates.
[[nodiscard]] std::vector<std::uint32_t> first_equal(std::span<const Eigen::Vector3d> positions);

/// Ascending indices of the points of the components that a rule keeps. Points closer than `reach`
/// belong to one component, points farther apart than 4 reach to two, unless other points connect
/// them. Of equally large components the first in Z order counts as the largest. Cost: about 0.1 us
/// per point.
[[nodiscard]] std::vector<std::uint32_t> kept_points(const ZOrderedCloud& points, double reach,
                                                     const PieceRule& rule);

/// Like kept_points(), for the vertices of a mesh: true for those of a component that the rule
/// keeps, and for those of no face. Faces with a common vertex are one component; its points are
/// its distinct vertices.
[[nodiscard]] std::vector<bool> kept_corners(const Mesh& mesh, const PieceRule& rule);

}  // namespace tactree::builder
