#include "scan/read_points.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <string_view>

#include "tactree/support/csv.hpp"

namespace tactree::cli {
namespace {

/// The columns of x, y and z: the first three without a line of names.
std::array<std::size_t, 3> columns_of(const support::CsvReader& table) {
  std::array<std::size_t, 3> columns{0, 1, 2};
  if (table.columns().empty()) {
    return columns;
  }
  constexpr std::string_view kNames[3][3] = {
      {"x", "X", "x_m"}, {"y", "Y", "y_m"}, {"z", "Z", "z_m"}};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::optional<std::size_t> found = table.find_column(kNames[axis]);
    if (!found) {
      table.refuse("the names of the columns do not include x, y and z",
                   "name them, or omit the line of names if x,y,z come first");
    }
    columns[axis] = *found;
  }
  return columns;
}

}  // namespace

std::vector<std::array<double, 3>> read_points(const std::filesystem::path& file) {
  support::CsvReader table(
      file, {.header = support::CsvHeader::kOptional, .separator = support::CsvSeparator::kAny});
  const auto [x, y, z] = columns_of(table);
  std::vector<std::array<double, 3>> points;
  while (table.next_row()) {
    if (table.cells().size() <= std::max({x, y, z})) {
      table.refuse("fewer values than columns", "each row is x,y,z in metres");
    }
    points.push_back({table.number(x), table.number(y), table.number(z)});
    for (const double coordinate : points.back()) {
      if (std::abs(coordinate) > static_cast<double>(std::numeric_limits<float>::max())) {
        table.refuse("a coordinate is not a float32 number", "give metres");
      }
    }
  }
  return points;
}

}  // namespace tactree::cli
