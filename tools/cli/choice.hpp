#pragma once
// Options whose value is one of several names.

#include <CLI/CLI.hpp>
#include <map>
#include <string>

namespace tactree::cli {

/// "a|b|c" as "a, b or c".
inline std::string listed(std::string names) {
  const std::size_t last = names.rfind('|');
  if (last != std::string::npos) {
    names.replace(last, 1, " or ");
  }
  for (std::size_t at = names.find('|'); at != std::string::npos; at = names.find('|')) {
    names.replace(at, 1, ", ");
  }
  return names;
}

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
