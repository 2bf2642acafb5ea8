#pragma once
// The options that state how scans are read.

#include <CLI/CLI.hpp>
#include <string>

#include "tactree/builder/read_scan.hpp"

namespace tactree::cli {

CLI::Option* add_format_option(CLI::App& verb, std::string& format);
CLI::Option* add_columns_option(CLI::App& verb, std::string& columns);

/// Throws CLI::ValidationError for a text that names no columns.
[[nodiscard]] builder::ColumnMap columns_of(const std::string& text);

}  // namespace tactree::cli
