#pragma once
// Checks of option values, for CLI::Option::check(). Their messages name the value and the range.

#include <string>

namespace tactree::cli {

/// Empty if `text` is a finite number above zero, else the error.
std::string is_positive(const std::string& text);
/// Empty if `text` is a finite number, zero or above, else the error.
std::string is_not_negative(const std::string& text);

}  // namespace tactree::cli
