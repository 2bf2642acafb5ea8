#pragma once
// The columns of a text file of points: by the names of a header line, by --columns, or by the
// numbers in them. Columns that do not look like points are never guessed.

#include <cstdint>
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
  std::size_t numbers = 0;  ///< fields before the first one that is not a number
};

struct ColumnGuess {
  std::vector<Slot> slots;             ///< per column
  std::optional<std::size_t> counter;  ///< column that numbers the points
  std::string doubt;                   ///< why the rows may be no points; empty: they are
  std::vector<std::string> warnings;
};

/// Finds x y z, and normals and colours, in rows without names. counted: the number of points came
/// before them, as in a PTS file.
[[nodiscard]] ColumnGuess guess_columns(std::span<const TextRow> rows, bool counted);

/// The columns that these names stand for; empty if x, y and z are not among them. Survey files
/// call them easting, northing and elevation.
[[nodiscard]] std::vector<Slot> slots_of_names(std::span<const std::string_view> names);

/// The same for the columns that the user has named.
[[nodiscard]] std::vector<Slot> slots_of_columns(const ColumnMap& columns);

/// Leaves out columns after the last one in use, and incomplete normals and colours.
void leave_out_unused(std::vector<Slot>& slots);

/// "x=2, y=3, z=4"
[[nodiscard]] std::string describe_columns(std::span<const Slot> slots);

}  // namespace tactree::builder
