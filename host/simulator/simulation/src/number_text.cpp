#include "number_text.hpp"

#include <charconv>
#include <cmath>

namespace tactree::simulation {

std::optional<double> parse_number(std::string_view text) {
  const char* const after = text.data() + text.size();
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), after, value);
  if (error != std::errc{} || end != after || !std::isfinite(value)) {
    return std::nullopt;
  }
  return value;
}

std::optional<double> parse_seconds(std::string_view text) {
  if (text.ends_with('s')) {
    text.remove_suffix(1);
  }
  return parse_number(text);
}

}  // namespace tactree::simulation
