#pragma once
// Advice about a model that seems to lie on its side.

#include <optional>
#include <string>

#include "tactree/core/model/blob.hpp"

namespace tactree::builder {

/// States that the body of a blob has its flat or open base at an end of x or y instead of z, and
/// how to turn it; nullopt for other models. A blob does not store with which options it was built,
/// so this is also stated if --axis z was given on purpose. An open base is noticed in models of up
/// to a million points. Cost: about 5 us per point and core; of a larger model 0.2 us.
[[nodiscard]] std::optional<std::string> up_advice(const core::BlobView& view);

}  // namespace tactree::builder
