#pragma once
// Poisson-disk selection: a subset of the points, evenly spread, none too close to another.

#include <cstdint>
#include <vector>

#include "z_order.hpp"

namespace tactree::builder {

/// Least distance of kept points, in spacings: a maximal selection with distance d from a dense
/// cloud has 0.697 points per d^2 (random sequential packing of discs), so this gives 1 per h^2.
inline constexpr double kDistanceOverSpacing = 0.83;

/// Two points compete when they are closer than the distance and face the same way: two sides of a
/// plate, or of an edge, do not. A point with unknown normal competes with every other.
inline constexpr float kSameSideCosine = 0.5F;

/// Indices (ascending) of the points kept: no two that compete, and every point that is not kept
/// competes with one that is. Deterministic for any number of threads.
/// Cost: about 0.3 us a point a core, 5 bytes a point.
[[nodiscard]] std::vector<std::uint32_t> select_poisson_disk(const ZOrderedCloud& points,
                                                             double distance);

}  // namespace tactree::builder
