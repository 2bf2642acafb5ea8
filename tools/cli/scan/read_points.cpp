#include "scan/read_points.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string_view>

#include "tactree/support/csv.hpp"

namespace tactree::cli {
namespace {

constexpr std::array<std::string_view, 3> kPointColumns[3] = {
    {"x", "X", "x_m"}, {"y", "Y", "y_m"}, {"z", "Z", "z_m"}};

}  // namespace

std::vector<std::array<double, 3>> read_points(const std::filesystem::path& file) {
  support::CsvReader table(
      file, {.header = support::CsvHeader::kOptional, .separator = support::CsvSeparator::kAny});
  const std::vector<std::size_t> columns =
      table.find_columns(kPointColumns, "name them, or omit the line of names if x,y,z come first");
  std::vector<std::array<double, 3>> points;
  while (table.next_row()) {
    if (table.cells().size() <= *std::max_element(columns.begin(), columns.end())) {
      table.refuse("fewer values than columns", "each row is x,y,z in metres");
    }
    points.push_back(
        {table.number(columns[0]), table.number(columns[1]), table.number(columns[2])});
    for (const double coordinate : points.back()) {
      if (std::abs(coordinate) > static_cast<double>(std::numeric_limits<float>::max())) {
        table.refuse("a coordinate is not a float32 number", "give metres");
      }
    }
  }
  return points;
}

}  // namespace tactree::cli
