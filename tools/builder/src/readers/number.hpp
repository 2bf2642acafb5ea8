#pragma once
// Numbers and tokens in text. No locale, no allocation; every view lies inside the given text.

#include <cstdint>
#include <string>
#include <string_view>

namespace tactree::builder {

[[nodiscard]] constexpr bool is_space(char c) {
  return c == ' ' || c == '\t' || c == '\r' || c == '\f' || c == '\v';
}

/// Without white space at both ends.
[[nodiscard]] std::string_view trim(std::string_view text);

/// Takes the next word (up to white space) off the front of `rest`; empty when there is none.
[[nodiscard]] inline std::string_view take_word(std::string_view& rest) {
  std::size_t begin = 0;
  while (begin < rest.size() && is_space(rest[begin])) ++begin;
  std::size_t end = begin;
  while (end < rest.size() && !is_space(rest[end])) ++end;
  const std::string_view word = rest.substr(begin, end - begin);
  rest.remove_prefix(end);
  return word;
}

/// Reads the whole of `token` as a number. A leading '+', nan and inf are accepted, also as
/// "1.#QNAN"; too large a number is infinite, too small a one is zero. Else false.
[[nodiscard]] bool parse_number(std::string_view token, double& value);

/// Reads the whole of `token` as an integer. A leading '+' is accepted.
[[nodiscard]] bool parse_integer(std::string_view token, std::int64_t& value);

/// ASCII only.
[[nodiscard]] bool equal_ignoring_case(std::string_view a, std::string_view b);
[[nodiscard]] bool starts_with_ignoring_case(std::string_view text, std::string_view prefix);

/// The first 60 characters for a message, with '?' for what does not print.
[[nodiscard]] std::string printable(std::string_view text);

}  // namespace tactree::builder
