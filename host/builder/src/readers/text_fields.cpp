#include "text_fields.hpp"

#include <algorithm>
#include <array>

#include "number.hpp"

namespace tactree::builder {
namespace {

constexpr std::size_t kFewestColumns = 3;

/// True if a '#' after this character does not begin a comment: "P#1" is a name, 1.#QNAN a number.
bool continues(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_' || c == '"' || c == '.';
}

/// True if several words of the text are numbers.
bool is_list_of_numbers(std::string_view text) {
  int numbers = 0;
  double value = 0;
  for (auto word = take_word(text); !word.empty(); word = take_word(text)) {
    numbers += parse_field(word, true, value) ? 1 : 0;
  }
  return numbers > 1;
}

std::string_view without_leading_space(std::string_view text, char separator) {
  std::size_t begin = 0;
  const auto skips = [&](char c) { return is_space(c) && (c != separator || separator == ' '); };
  while (begin < text.size() && skips(text[begin])) ++begin;
  return text.substr(begin);
}

/// Length of a quoted field at the front of the text; 0 if there is none.
std::size_t quoted_length(std::string_view text, char separator) {
  if (!text.starts_with('"')) return 0;
  const std::size_t close = text.find('"', 1);
  if (close == std::string_view::npos) return 0;
  const std::string_view after = text.substr(close + 1);
  const std::string_view next = without_leading_space(after, separator);
  const bool ends =
      next.empty() || (separator == ' ' ? next.size() < after.size() : next.front() == separator);
  return ends ? close + 1 : 0;
}

}  // namespace

std::string_view text_of_line(std::string_view line) {
  line = trim(line);
  if (line.starts_with('%') || line.starts_with('!')) return {};
  std::size_t end = line.find('#');
  while (end != std::string_view::npos && end > 0 && continues(line[end - 1])) {
    end = line.find('#', end + 1);
  }
  line = line.substr(0, end);
  line = line.substr(0, line.find("//"));
  return trim(line);
}

bool has_decimal_commas(std::string_view row) {
  std::size_t words = 0;
  for (auto word = take_word(row); !word.empty(); word = take_word(row)) {
    ++words;
    const std::size_t comma = word.find(',');
    if (comma == std::string_view::npos) continue;
    if (word.find(',', comma + 1) != std::string_view::npos) return false;
    if (comma == 0 || comma + 1 >= word.size()) return false;
    if (!is_digit(word[comma - 1]) || !is_digit(word[comma + 1])) return false;
  }
  return words >= kFewestColumns;
}

bool has_tab_fields(std::string_view line) {
  std::size_t fields = 0;
  std::string_view field;
  while (take_field(line, '\t', field)) {
    if (is_list_of_numbers(field)) return false;
    ++fields;
  }
  return fields >= kFewestColumns;
}

FieldStyle style_of_row(std::string_view row) {
  const bool comma = row.find(',') != std::string_view::npos;
  if (row.find(';') != std::string_view::npos) return {';', true};
  if (has_tab_fields(row)) return {'\t', true};
  if (comma && !has_decimal_commas(row)) return {',', false};
  return {' ', comma};
}

bool take_field(std::string_view& rest, char separator, std::string_view& field) {
  if (separator != ' ' && rest.data() == nullptr) return false;
  rest = without_leading_space(rest, separator);
  if (separator == ' ' && rest.empty()) return false;
  const std::size_t quoted = quoted_length(rest, separator);
  if (quoted != 0) {
    field = trim(rest.substr(1, quoted - 2));
    rest.remove_prefix(quoted);
    if (separator == ' ') return true;
  } else if (separator == ' ') {
    field = take_word(rest);
    return true;
  }
  const std::size_t end = rest.find(separator);
  if (quoted == 0) field = trim(rest.substr(0, end));
  rest = end == std::string_view::npos ? std::string_view{} : rest.substr(end + 1);
  return true;
}

bool parse_field(std::string_view field, bool decimal_comma, double& value) {
  if (!decimal_comma || field.find(',') == std::string_view::npos) {
    return parse_number(field, value);
  }
  std::array<char, 64> text{};
  if (field.size() > text.size()) return false;
  std::replace_copy(field.begin(), field.end(), text.begin(), ',', '.');
  return parse_number({text.data(), field.size()}, value);
}

}  // namespace tactree::builder
