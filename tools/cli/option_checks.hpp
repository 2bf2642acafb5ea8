#pragma once
// Checks of option values, for CLI::Option::check(). Their messages name the value and the range.

#include <CLI/CLI.hpp>
#include <map>
#include <string>
#include <vector>

namespace tactree::cli {

/// Accepts finite numbers from `low` to `high`. CLI::Range also accepts "nan".
[[nodiscard]] CLI::Validator within(double low, double high);

/// Accepts these names, in any case, and replaces the text by the name.
[[nodiscard]] CLI::Validator one_of(const std::vector<std::string>& names);

/// Accepts files that exist. Throws UserError for others: that a file is missing is no misuse of
/// the command, and has the exit code that it has for an argument that is read later.
[[nodiscard]] CLI::Validator existing_file();

/// Empty if `text` is a finite number above zero, else the error.
std::string is_positive(const std::string& text);
/// Empty if `text` is a finite number, zero or above, else the error.
std::string is_not_negative(const std::string& text);

/// For an output that is written as one format, with this extension: refuses the extension of
/// another one.
[[nodiscard]] CLI::Validator written_as(const std::string& extension);

/// "a|b|c" as "a, b or c".
[[nodiscard]] std::string listed(std::string names);

/// Turns a name into its value. `shown`: the names as the help shows them, "a|b|c".
template <typename Value>
CLI::Validator choice(const std::map<std::string, Value>& names, const std::string& shown) {
  const auto convert = [to_value = CLI::CheckedTransformer(names), shown](std::string& text) {
    const std::string given = text;
    return to_value(text).empty() ? std::string() : "'" + given + "' is not " + listed(shown);
  };
  return {convert, shown};
}

}  // namespace tactree::cli
