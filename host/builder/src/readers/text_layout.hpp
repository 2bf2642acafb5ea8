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
#include "text_fields.hpp"

namespace tactree::builder {

struct TextLayout {
  FieldStyle style;
  std::vector<Slot> slots;                ///< per column, up to the last one in use
  std::optional<double> unit_m;           ///< that the file states for x, y and z
  std::uint64_t unit_line = 0;            ///< line of this statement
  bool has_commas = false;                ///< some numbers have a decimal comma
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

/// Reads the first rows and rewinds the file. Throws ReadError if they are not points. `columns`
/// are those that the user has named, or empty.
[[nodiscard]] TextLayout find_text_layout(InputFile& file, const ColumnMap& columns);

}  // namespace tactree::builder
