#pragma once
// How a text file of points is laid out: separator, columns, leading count. Decided from its
// first rows.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "input_file.hpp"
#include "scan_builder.hpp"

namespace tactree::builder {

struct TextLayout {
  char separator = ' ';                   ///< ' ' stands for any run of white space
  bool decimal_comma = false;             ///< "1,5" is one and a half
  std::vector<Slot> slots;                ///< per column
  std::optional<std::uint64_t> promised;  ///< the count that comes before the first point
  std::uint64_t header_line = 0;          ///< of the column names; 0: none
  std::uint64_t first_row_line = 0;
  double row_bytes = 0;  ///< on average
  std::vector<std::string> warnings;

  [[nodiscard]] bool has(Slot slot) const;
};

/// The part of a line that counts: without comments ('#', "//"), a byte order mark and spaces.
[[nodiscard]] std::string_view text_of_line(std::string_view line);

/// Takes the next field off the front of `rest`, without quotes and spaces around it. False at
/// the end of the line.
[[nodiscard]] bool take_field(std::string_view& rest, char separator, std::string_view& field);

/// parse_number, with a decimal comma when the layout has it.
[[nodiscard]] bool parse_field(std::string_view field, bool decimal_comma, double& value);

/// Reads the first rows and goes back to the start. Throws ReadError when they are not points.
[[nodiscard]] TextLayout find_text_layout(InputFile& file);

}  // namespace tactree::builder
