#include "number.hpp"

#include <charconv>
#include <cmath>
#include <limits>
#include <system_error>

namespace tactree::builder {
namespace {

constexpr char lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

/// Value of a number that is out of range. from_chars does not distinguish overflow from underflow,
/// but the sign of the exponent does.
double saturated(std::string_view token) {
  const bool negative = token.front() == '-';
  const std::size_t exponent = token.find_first_of("eE");
  const bool small = exponent != std::string_view::npos
                         ? token.substr(exponent + 1).starts_with('-')
                         : token.substr(negative ? 1 : 0).starts_with("0.");
  if (small) return 0.0;
  const double infinity = std::numeric_limits<double>::infinity();
  return negative ? -infinity : infinity;
}

/// "1.#QNAN", "-1.#IND", "1.#INF": NaN and infinity as printed by older Windows programs.
bool parse_hash_form(std::string_view rest, double& value) {
  if (!rest.starts_with('#')) return false;
  const bool infinite = rest.starts_with("#INF");
  if (!infinite && !rest.starts_with("#QNAN") && !rest.starts_with("#SNAN") &&
      !rest.starts_with("#IND")) {
    return false;
  }
  value =
      infinite ? std::numeric_limits<double>::infinity() : std::numeric_limits<double>::quiet_NaN();
  return true;
}

std::string_view without_plus(std::string_view token) {
  const bool plus = token.size() > 1 && token[0] == '+' && token[1] != '-' && token[1] != '+';
  return plus ? token.substr(1) : token;
}

}  // namespace

std::string_view trim(std::string_view text) {
  while (!text.empty() && is_space(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_space(text.back())) text.remove_suffix(1);
  return text;
}

bool parse_number(std::string_view token, double& value) {
  token = without_plus(token);
  if (token.empty()) return false;
  const char* end = token.data() + token.size();
  const auto [stop, error] = std::from_chars(token.data(), end, value);
  if (error == std::errc::invalid_argument) return false;
  if (error == std::errc::result_out_of_range) value = saturated(token);
  if (stop == end) return true;
  return parse_hash_form({stop, static_cast<std::size_t>(end - stop)}, value);
}

bool parse_integer(std::string_view token, std::int64_t& value) {
  token = without_plus(token);
  const char* end = token.data() + token.size();
  const auto [stop, error] = std::from_chars(token.data(), end, value);
  return error == std::errc{} && stop == end && !token.empty();
}

bool parse_corner(std::string_view token, std::int64_t& value) {
  if (parse_integer(token, value)) return true;
  double number = 0;
  if (!parse_number(token, number)) return false;
  constexpr double kIndexEnd = 4294967296.0;
  const bool index = number >= 0.0 && number < kIndexEnd && number == std::floor(number);
  value = index ? static_cast<std::int64_t>(number) : -1;
  return true;
}

bool equal_ignoring_case(std::string_view a, std::string_view b) {
  return a.size() == b.size() && starts_with_ignoring_case(a, b);
}

bool starts_with_ignoring_case(std::string_view text, std::string_view prefix) {
  if (text.size() < prefix.size()) return false;
  for (std::size_t i = 0; i < prefix.size(); ++i) {
    if (lower(text[i]) != lower(prefix[i])) return false;
  }
  return true;
}

std::string printable(std::string_view text) {
  constexpr std::size_t kMaxChars = 60;
  std::string shown(text.substr(0, kMaxChars));
  for (char& c : shown) {
    if (c < ' ' || c > '~') c = '?';
  }
  return shown;
}

}  // namespace tactree::builder
