#pragma once
// Checks of option values, for CLI::Option::check(). Their messages name the value and the range.

#include <CLI/CLI.hpp>
#include <string>

namespace tactree::cli {

/// Accepts finite numbers from `low` to `high`. CLI::Range also accepts "nan".
[[nodiscard]] CLI::Validator within(double low, double high);

/// Empty if `text` is a finite number above zero, else the error.
std::string is_positive(const std::string& text);
/// Empty if `text` is a finite number, zero or above, else the error.
std::string is_not_negative(const std::string& text);

/// For an output that is written as one format, with this extension: refuses the extension of
/// another one.
[[nodiscard]] CLI::Validator written_as(const std::string& extension);

}  // namespace tactree::cli
