#include "scan/reading_options.hpp"

#include <stdexcept>

#include "option_checks.hpp"

namespace tactree::cli {

CLI::Option* add_format_option(CLI::App& verb, std::string& format) {
  return verb
      .add_option("--format", format,
                  "format of the inputs, if it cannot be recognised by their content")
      ->check(one_of(builder::scan_formats()));
}

CLI::Option* add_columns_option(CLI::App& verb, std::string& columns) {
  return verb.add_option(
      "--columns", columns,
      "columns of text files, from 1: x=2,y=3,z=4, also nx, ny, nz, red, green, blue "
      "(default: by their names, or by their numbers)");
}

builder::ColumnMap columns_of(const std::string& text) {
  if (text.empty()) {
    return {};
  }
  try {
    return builder::parse_columns(text);
  } catch (const std::invalid_argument& error) {
    throw CLI::ValidationError("--columns", error.what());
  }
}

}  // namespace tactree::cli
