#pragma once
// How many points one query of a controller can meet: what a tick's time depends on.

#include <cstdint>

#include "octree_builder.hpp"
#include "tactree/core/blob_format.hpp"

namespace tactree::builder {

struct QueryBound {
  std::uint32_t points = 0;           ///< in the eight leaves of any query
  std::uint32_t points_per_slab = 0;  ///< of these, in any slab across z that is 2 reach_m thick
};

/// With leaves of one size the eight leaves are a 2 x 2 x 2 block, and both figures are exact; else
/// the eight fullest leaves are a bound of both.
[[nodiscard]] QueryBound query_bound(const Octree& tree, core::Profile profile, double reach_m);

}  // namespace tactree::builder
