#pragma once
// Numbers and tokens in text. Independent of the locale; every view refers to the given text.

#include <cstdint>
#include <string>
#include <string_view>

namespace tactree::builder {

[[nodiscard]] constexpr bool is_space(char c) {
  return c == ' ' || c == '\t' || c == '\r' || c == '\f' || c == '\v';
}

[[nodiscard]] constexpr bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// Removes white space at both ends.
[[nodiscard]] std::string_view trim(std::string_view text);

/// Removes the next word (up to white space) from the front of `rest` and returns it; empty if
/// there is none.
[[nodiscard]] inline std::string_view take_word(std::string_view& rest) {
  std::size_t begin = 0;
  while (begin < rest.size() && is_space(rest[begin])) ++begin;
  std::size_t end = begin;
  while (end < rest.size() && !is_space(rest[end])) ++end;
  const std::string_view word = rest.substr(begin, end - begin);
  rest.remove_prefix(end);
  return word;
}

/// Parses all of `token` as a number. Accepts a leading '+', nan and inf, also as "1.#QNAN".
/// Overflow gives infinity, underflow zero. Returns false for any other text.
[[nodiscard]] bool parse_number(std::string_view token, double& value);

/// Parses all of `token` as an integer. Accepts a leading '+'.
[[nodiscard]] bool parse_integer(std::string_view token, std::int64_t& value);

/// Parses a vertex index. A number that is not an index, such as nan or 1e30, becomes -1, so that
/// its face is dropped and counted. Returns false for other text.
[[nodiscard]] bool parse_corner(std::string_view token, std::int64_t& value);

/// Ignores the case of ASCII letters only.
[[nodiscard]] bool equal_ignoring_case(std::string_view a, std::string_view b);
[[nodiscard]] bool starts_with_ignoring_case(std::string_view text, std::string_view prefix);

/// Returns the first 60 characters for a message; unprintable characters become '?'.
[[nodiscard]] std::string printable(std::string_view text);

}  // namespace tactree::builder
