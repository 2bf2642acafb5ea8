#pragma once
// Checks whether the normals of a file can be used at all.

#include "geometry/z_order.hpp"

namespace tactree::builder {

/// True if the normals of neighbours oppose each other so often that their signs are random: in
/// more than a quarter of the pairs compared, at up to 4096 points. Thin plates stay below this.
[[nodiscard]] bool signs_are_random(const ZOrderedCloud& points, double spacing);

}  // namespace tactree::builder
