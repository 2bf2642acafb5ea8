#pragma once
// How far apart the points of a cloud are.

#include "z_order.hpp"

namespace tactree::builder {

/// The edge of the square that one point of the surface has to itself: the median over a regular
/// sample of points, each from the area its 16 nearest neighbours cover. A square grid of edge h
/// gives h within 5 %. 0 for fewer than two points. Deterministic. Cost: a few ms.
[[nodiscard]] double estimate_spacing(const ZOrderedCloud& points);

/// The edge of the cells that hold about 16 points each: a scale to begin a search with.
[[nodiscard]] double coarse_cell_edge(const ZOrderedCloud& points);

}  // namespace tactree::builder
