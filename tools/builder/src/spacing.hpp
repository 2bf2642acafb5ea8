#pragma once
// How far apart the points of a cloud are.

#include "z_order.hpp"

namespace tactree::builder {

/// How far apart points are, of a regular sample of them, each from the area that its 16 nearest
/// neighbours cover (of fewer than 32 points: the distance to the nearest). A square grid of edge h
/// gives h within 5 %. Deterministic. Cost: a few ms.
struct SpacingEstimate {
  double median_m = 0.0;  ///< of the points: half of them are closer; 0 for fewer than two points
  double mean_m = 0.0;    ///< of the surface: sqrt(area / points), without the sparsest 2 %
};
[[nodiscard]] SpacingEstimate estimate_spacing(const ZOrderedCloud& points);

/// The edge of the cells that hold about 16 points each: a scale to begin a search with.
[[nodiscard]] double coarse_cell_edge(const ZOrderedCloud& points);

}  // namespace tactree::builder
