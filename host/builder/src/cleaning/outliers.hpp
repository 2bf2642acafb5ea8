#pragma once
// Detection of outliers: isolated points far from any surface.

#include <cstdint>
#include <span>
#include <vector>

#include "geometry/z_order.hpp"

namespace tactree::builder {

/// Box outside of which points are implausible: the inner 98 % on each axis (excluding at least 10
/// points and at most an eighth of them), grown on every side by `margin` times its longest edge.
/// Outliers do not influence it. Empty (no estimate) for fewer than 8 points or if most points
/// coincide.
[[nodiscard]] Box plausible_box(std::span<const Eigen::Vector3d> positions, double margin);

/// Ascending indices of the points that are not isolated. A point is kept if at least 8 others (one
/// in 32 of fewer than 256 points) lie in the 27 cells around it; the edge of a cell is 10 to 20
/// `spacing`. If this would drop more than 0.1 % of the points and more than 10, the density of the
/// scan is uneven, and the cells are doubled until it does not.
[[nodiscard]] std::vector<std::uint32_t> points_in_company(const ZOrderedCloud& points,
                                                           double spacing);

}  // namespace tactree::builder
