#pragma once
// Converts a sheet to a body, which can be touched from both sides.

#include <cstdint>

#include "geometry/z_order.hpp"

namespace tactree::builder {

struct Thickened {
  ZOrderedCloud points;
  std::uint64_t at_edge = 0;  ///< number of points on the round edge
};

/// Moves two copies of the sheet apart by `thickness`, along its normals and against them, and
/// closes its edges, also around holes, by half a cylinder. Preconditions: normals of unit length,
/// which agree between neighbours; their orientation does not matter. `radius` is that of the
/// surface fit. A sheet that is curved more tightly than half the thickness intersects itself.
/// Deterministic. Cost: about 5 us per point and core.
[[nodiscard]] Thickened thicken(const ZOrderedCloud& sheet, double spacing, double radius,
                                double thickness);

}  // namespace tactree::builder
