#pragma once
// Detection of stray points: points of a scan that lie on no surface, at any distance from it.

#include <cstdint>
#include <vector>

#include "geometry/z_order.hpp"

namespace tactree::builder {

struct SurfacePoints {
  std::vector<std::uint32_t> kept;  ///< indices, ascending
  bool undecided = false;           ///< too many would be dropped: all are kept
};

/// The points that lie on a surface: a plane through the point holds a good part of its 20 nearest
/// neighbours, within `sigma` times the noise of the scan (at least 7 % of its spacing). Only
/// suspects are tested: points with few others around them, and points that stand out from the
/// plane of their surroundings. A sparse part of a scan, a thin wire, an edge and both sides of a
/// plate are surfaces. Finds nearly all stray points beyond three spacings from the surface, fewer
/// of those nearer to it. If more than an eighth would be dropped, the scan is no surface at this
/// scale and all are kept; so are scans of fewer than 2000 points.
/// `spacing`: median of the scan. Deterministic for any number of threads. Cost: about 0.1 us per
/// point and core, and 10 us per suspect.
[[nodiscard]] SurfacePoints points_on_surfaces(const ZOrderedCloud& points, double spacing,
                                               double sigma);

}  // namespace tactree::builder
