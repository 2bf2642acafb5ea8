#pragma once

#include <initializer_list>
#include <string>
#include <string_view>

namespace tactree::viewer {

/// The trace `csv` without the named columns. Precondition: every row has the header's columns.
[[nodiscard]] std::string without_columns(std::string_view csv,
                                          std::initializer_list<std::string_view> names);

}  // namespace tactree::viewer
