#pragma once
// Whether the normals of a file can be used at all.

#include "geometry/z_order.hpp"

namespace tactree::builder {

/// Whether the normals of near neighbours oppose each other so often that their signs are random:
/// at more than a quarter of up to 4096 points' neighbours. Thin plates stay below.
[[nodiscard]] bool signs_are_random(const ZOrderedCloud& points, double spacing);

}  // namespace tactree::builder
