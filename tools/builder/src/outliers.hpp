#pragma once
// Points that belong to no surface: strays of a scanner, far from everything else.

#include <cstdint>
#include <span>
#include <vector>

#include "z_order.hpp"

namespace tactree::builder {

/// A box that no point of an ordinary scan leaves: the innermost 98 % on each axis (all but 10
/// points at least, an eighth of the points at most), grown on every side by `margin` times its
/// longest edge. Empty, which means "no idea", for fewer than 8 points or when most points share
/// one place. Strays outside it, however far, have no influence on it.
[[nodiscard]] Box plausible_box(std::span<const Eigen::Vector3d> positions, double margin);

/// Indices (ascending) of the points that are not alone: at least 8 others (of fewer than 256
/// points: one in 32) lie in the 27 cells around them, of edge 10 to 20 `spacing`. Where that would
/// drop more than 0.1 % of the points (and more than 10), the scan is merely uneven: cells are
/// doubled until it does not.
[[nodiscard]] std::vector<std::uint32_t> points_in_company(const ZOrderedCloud& points,
                                                           double spacing);

}  // namespace tactree::builder
