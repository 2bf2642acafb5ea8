#pragma once
// Units of length by their names.

#include <optional>
#include <string_view>

namespace tactree::builder {

/// Metres per unit of a name such as "mm", "feet" or "US survey ft", in any case of its letters;
/// nothing if it is not known.
[[nodiscard]] std::optional<double> metres_of_unit(std::string_view name);

}  // namespace tactree::builder
