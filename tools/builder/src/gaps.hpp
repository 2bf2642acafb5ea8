#pragma once
// Where the surface has holes: places that the scan did not see, or the object's open ends.

#include <span>
#include <vector>

#include "tactree/builder/build_model.hpp"
#include "z_order.hpp"

namespace tactree::builder {

struct Gaps {
  double largest_m = 0.0;  ///< widest hole; where there is none, widest empty ball in between
  std::vector<Opening> openings;  ///< wider than `radius`, widest first
};

/// A point is at the border when its neighbours leave a wedge of 120 degrees of its tangent plane
/// empty, and that wedge's middle holds no point within `radius`. Border points near each other
/// make an opening: a hole when the wedges face each other, else a rim.
/// Holes down to 1.2 times the radius are found; their diameter within about one spacing.
/// radius: of the surface fit, 2.5 spacings. Deterministic. Cost: about 5 us a point a core.
[[nodiscard]] Gaps find_gaps(const ZOrderedCloud& points, double spacing, double radius);

}  // namespace tactree::builder
