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

/// Finds the points that lie on a surface: a plane through the point holds many of its 20 nearest
/// neighbours, within `sigma` times the noise of the scan (taken as at least 10 % of the spacing,
/// or 6 % for sparse points). Only suspects are tested: points with few others around them, and
/// points off the plane of their surroundings. A sparse part of a scan, a thin wire, an edge and
/// both sides of a plate are surfaces. Finds nearly all stray points farther than three spacings
/// from the surface, and fewer of the nearer ones. Keeps all points if more than an eighth would be
/// dropped, because the scan is then no surface at this scale, and in scans of fewer than 2000
/// points. `spacing` is the median of the scan. Deterministic for any number of threads. Cost:
/// about 0.1 us per point and core, and 10 us per suspect.
[[nodiscard]] SurfacePoints points_on_surfaces(const ZOrderedCloud& points, double spacing,
                                               double sigma);

}  // namespace tactree::builder
