#pragma once
// Checks whether a model has a size that the user of a haptic device can feel.

#include <optional>
#include <string>

namespace tactree::builder {

/// Returns "the model is 4.6 km wide, but ... (hint)" if the longest edge is more than 1 m or
/// less than 5 mm, because the unit is then probably wrong. Returns nullopt for other sizes and for
/// 0.
[[nodiscard]] std::optional<std::string> size_advice(double longest_edge_m);

}  // namespace tactree::builder
