#pragma once
// Finds the openings of the surface in an existing blob.

#include <vector>

#include "tactree/builder/build_model.hpp"
#include "tactree/core/model/blob.hpp"

namespace tactree::builder {

/// The openings wider than kBridgedSpacings, widest first, as in the report of the build.
/// Cost: about 5 us per point and core.
[[nodiscard]] std::vector<Opening> find_openings(const core::BlobView& view);

}  // namespace tactree::builder
