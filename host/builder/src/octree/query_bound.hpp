#pragma once
// Maximum number of points that one query of a controller visits; it bounds the time of a tick.

#include <cstdint>

#include "octree/octree_builder.hpp"
#include "tactree/core/model/blob_format.hpp"

namespace tactree::builder {

struct QueryBound {
  std::uint32_t points = 0;           ///< in the eight leaves of any query
  std::uint32_t points_per_slab = 0;  ///< maximum in a slab across z that is 2 reach_m thick
};

/// If all leaves have one size, the eight leaves are a 2 x 2 x 2 block and both values are exact.
/// Otherwise both are bounded by the eight fullest leaves.
[[nodiscard]] QueryBound query_bound(const Octree& tree, core::Profile profile, double reach_m);

}  // namespace tactree::builder
