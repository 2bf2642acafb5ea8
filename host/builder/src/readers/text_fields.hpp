#pragma once
// The fields of a line of text: comments, separators, quotes, decimal commas.

#include <string_view>

namespace tactree::builder {

/// How the fields of a row are written.
struct FieldStyle {
  char separator = ' ';        ///< ' ' stands for any run of white space
  bool decimal_comma = false;  ///< "1,5" means 1.5
};

/// Returns the data of a line, without comments ("//" and '#', except directly after a letter; '%'
/// and '!' at its beginning) and the spaces around it.
[[nodiscard]] std::string_view text_of_line(std::string_view line);

/// Returns the style of a row. With white space or commas between fields, it depends on the row
/// whether commas are decimal.
[[nodiscard]] FieldStyle style_of_row(std::string_view row);

/// True for a row such as "1,5 2,5 3": at most one comma in a word, between digits, and three words
/// or more.
[[nodiscard]] bool has_decimal_commas(std::string_view row);

/// True if a line has three or more fields with tabs between them, none of which is a list of
/// numbers.
[[nodiscard]] bool has_tab_fields(std::string_view line);

/// Removes the next field from the front of `rest`, without quotes and spaces around it. Returns
/// false at the end of the line.
[[nodiscard]] bool take_field(std::string_view& rest, char separator, std::string_view& field);

/// Like parse_number(), with the decimal separator of the style.
[[nodiscard]] bool parse_field(std::string_view field, bool decimal_comma, double& value);

}  // namespace tactree::builder
