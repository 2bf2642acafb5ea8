#pragma once
// Finds holes and open edges of a sampled surface.

#include <vector>

#include "geometry/z_order.hpp"
#include "tactree/builder/build_model.hpp"

namespace tactree::builder {

struct Gaps {
  double largest_m = 0.0;         ///< diameter of the widest hole or empty ball
  std::vector<Opening> openings;  ///< wider than kBridgedSpacings, widest first
};

/// A point is a border point if its neighbours leave a wedge of 120 degrees of its tangent plane
/// empty, the central part of the wedge holds no point within `radius`, and the surface does not
/// turn there at an edge or around the edge of a plate thinner than `radius`. Adjacent border
/// points form an opening: a hole if their wedges face each other, otherwise a boundary. A hole
/// is as wide as the widest ball without points between its border points: those of the voids of a
/// random cloud may lie beside each other in a long row. Finds holes from 1.2 radii; their
/// diameter is accurate to about one spacing. `watertight` means that the points were sampled from
/// a closed mesh, which has no openings. `radius` is that of the surface fit, 2.5 spacings.
/// Deterministic. Cost: about 5 us per point and core.
[[nodiscard]] Gaps find_gaps(const ZOrderedCloud& points, double spacing, double radius,
                             bool watertight = false);

/// Returns per point the zero vector, or for a border point the unit vector in its tangent plane
/// towards the missing surface.
[[nodiscard]] std::vector<Eigen::Vector3f> border_directions(const ZOrderedCloud& points,
                                                             double spacing, double radius);

}  // namespace tactree::builder
