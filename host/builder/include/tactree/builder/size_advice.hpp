#pragma once
// Whether a model has a size that a hand at a haptic device can feel.

#include <optional>
#include <string>

namespace tactree::builder {

/// "the model is 4.6 km wide, but ... (remedy)" for a longest edge of more than 1 m or less than
/// 5 mm: its unit is probably wrong. Empty for others, and for 0.
[[nodiscard]] std::optional<std::string> size_advice(double longest_edge_m);

}  // namespace tactree::builder
