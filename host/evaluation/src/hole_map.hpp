#pragma once
// Map of the openings of a scan.

#include <span>
#include <string>

#include "tactree/builder/build_model.hpp"
#include "tactree/core/model/blob.hpp"

namespace tactree::evaluation {

/// SVG picture of the model from three sides at the same scale, with a circle of the size of each
/// opening. Precondition: !view.empty().
[[nodiscard]] std::string hole_map_svg(const core::BlobView& view,
                                       std::span<const builder::Opening> openings);

}  // namespace tactree::evaluation
