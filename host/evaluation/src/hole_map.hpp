#pragma once
// Where the surface of a scan ends, as a picture.

#include <span>
#include <string>

#include "tactree/builder/build_model.hpp"
#include "tactree/core/blob.hpp"

namespace tactree::evaluation {

/// An SVG picture: the model from three sides, to one scale, and a circle as wide as each opening.
/// Precondition: !view.empty().
[[nodiscard]] std::string hole_map_svg(const core::BlobView& view,
                                       std::span<const builder::Opening> openings);

}  // namespace tactree::evaluation
