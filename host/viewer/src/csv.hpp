#pragma once
// Traces as text. No value may hold a comma.

#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

namespace tactree::viewer {

[[nodiscard]] std::vector<std::string_view> cells_of(std::string_view line);

/// The text without the columns of these names.
[[nodiscard]] std::string without_columns(std::string_view csv,
                                          std::initializer_list<std::string_view> names);

}  // namespace tactree::viewer
