#pragma once
// A line that names the columns of a text file of points.

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "scan_builder.hpp"

namespace tactree::builder {

struct ColumnNames {
  std::vector<Slot> slots;       ///< per column; empty: x, y and z are not among the names
  std::size_t count = 0;         ///< number of names
  std::optional<double> unit_m;  ///< that the names of x, y and z state
  std::string contradiction;     ///< why the names are ambiguous; empty if they are not
};

/// Reads names such as `x,y,z`, `//X Y Z`, `"Easting [ft]";...` or `Format: x y z`. Easting,
/// northing and elevation stand for x, y and z, and so do names with a unit, such as x_mm.
[[nodiscard]] ColumnNames read_column_names(std::string_view line);

/// The unit of x, y and z in a line of units below their names, such as `mm,mm,mm`. Nothing if it
/// is another line. 0: the units differ.
[[nodiscard]] std::optional<double> read_column_units(std::string_view line, char separator,
                                                      const std::vector<Slot>& slots);

/// The unit in a line such as `Units: mm` or `# unit = US survey feet`; empty if it states none.
[[nodiscard]] std::string_view stated_unit(std::string_view line);

/// What to do about a table whose names do not include x, y and z.
[[nodiscard]] std::string remedy_of_names(std::string_view line);

}  // namespace tactree::builder
