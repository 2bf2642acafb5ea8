#pragma once
// Numbers in the texts of options and files.

#include <optional>
#include <string_view>

namespace tactree::simulation {

/// The finite number that is all of `text`; empty if it is anything else.
[[nodiscard]] std::optional<double> parse_number(std::string_view text);

/// A time in seconds, with or without the unit s.
[[nodiscard]] std::optional<double> parse_seconds(std::string_view text);

}  // namespace tactree::simulation
