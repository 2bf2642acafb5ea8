#pragma once
// Determines the columns of a text file of points: by the names of a header line, by --columns, or
// by the numbers in them. Columns that do not look like points are never guessed.

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "scan_builder.hpp"
#include "tactree/builder/read_scan.hpp"

namespace tactree::builder {

/// The numbers of a row; NaN for other text.
struct TextRow {
  std::vector<double> values;
  std::size_t numbers = 0;  ///< number of fields before the first one that is not a number
};

struct ColumnGuess {
  std::vector<Slot> slots;             ///< per column
  std::optional<std::size_t> counter;  ///< column that numbers the points
  std::string doubt;                   ///< why the rows may not be points; empty if they are
  std::string remark;                  ///< a choice to be reported; may be empty
  std::vector<std::string> warnings;
};

/// The number of values that most of the rows have; of equally frequent ones the lowest.
[[nodiscard]] std::size_t most_frequent_width(std::span<const TextRow> rows);

/// Finds x y z, and normals and colours, in rows without names. `counted` means that the number of
/// points precedes the rows, as in a PTS file.
[[nodiscard]] ColumnGuess guess_columns(std::span<const TextRow> rows, bool counted);

/// Returns the columns with these names; empty if x, y and z are not among them. Easting, northing
/// and elevation, as in survey files, are accepted too.
[[nodiscard]] std::vector<Slot> slots_of_names(std::span<const std::string_view> names);

/// Returns the columns that the user has named.
[[nodiscard]] std::vector<Slot> slots_of_columns(const ColumnMap& columns);

/// Clears incomplete normals and colours, and removes the columns after the last one in use.
void leave_out_unused(std::vector<Slot>& slots);

/// Formats columns: "x=2, y=3, z=4".
[[nodiscard]] std::string describe_columns(std::span<const Slot> slots);

}  // namespace tactree::builder
