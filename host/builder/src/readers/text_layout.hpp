#pragma once
// Layout of a text file of points: separator, columns, leading count. It is determined from the
// first rows of the file.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "input_file.hpp"
#include "scan_builder.hpp"
#include "tactree/builder/read_scan.hpp"

namespace tactree::builder {

struct TextLayout {
  char separator = ' ';                   ///< ' ' stands for any run of white space
  bool decimal_comma = false;             ///< "1,5" means 1.5
  std::vector<Slot> slots;                ///< per column, up to the last one in use
  std::optional<std::size_t> counter;     ///< column that numbers the points
  std::optional<std::uint64_t> declared;  ///< the count that precedes the first point
  std::uint64_t header_line = 0;          ///< line of the column names; 0: none
  std::uint64_t first_row_line = 0;
  double row_bytes = 0;  ///< average
  std::vector<std::string> warnings;
  std::string remark;  ///< a choice to be reported; may be empty
  std::string source;  ///< origin of the columns, for messages: "named by line 1"

  [[nodiscard]] bool has(Slot slot) const;
};

/// Returns the data of a line, without comments ('#', "//", and '%' or '!' at its beginning) and
/// the spaces around it.
[[nodiscard]] std::string_view text_of_line(std::string_view line);

/// Removes the next field from the front of `rest`, without quotes and spaces around it. Returns
/// false at the end of the line.
[[nodiscard]] bool take_field(std::string_view& rest, char separator, std::string_view& field);

/// Like parse_number(), with the decimal separator of the layout.
[[nodiscard]] bool parse_field(std::string_view field, bool decimal_comma, double& value);

/// Reads the first rows and rewinds the file. Throws ReadError if they are not points. `columns`
/// are those that the user has named, or empty.
[[nodiscard]] TextLayout find_text_layout(InputFile& file, const ColumnMap& columns);

}  // namespace tactree::builder
