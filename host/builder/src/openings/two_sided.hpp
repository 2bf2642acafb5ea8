#pragma once
// Makes a body of a sheet, which a hand can touch from both sides.

#include <cstdint>

#include "geometry/z_order.hpp"

namespace tactree::builder {

struct Thickened {
  ZOrderedCloud points;
  std::uint64_t at_edge = 0;  ///< of them: on the round edge
};

/// Moves two copies of the sheet apart by `thickness`, along its normals and against them, and
/// closes its edges, also around holes, by half a cylinder. Normals of unit length; those of
/// neighbours agree, their side does not matter. radius: of the surface fit. A sheet that is curved
/// more tightly than half the thickness intersects itself. Deterministic. Cost: about 5 us per
/// point and core.
[[nodiscard]] Thickened thicken(const ZOrderedCloud& sheet, double spacing, double radius,
                                double thickness);

}  // namespace tactree::builder
