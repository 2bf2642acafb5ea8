#include "scan/read_points.hpp"

#include "tactree/support/csv.hpp"

namespace tactree::cli {

std::vector<std::array<double, 3>> read_points(const std::filesystem::path& file) {
  support::CsvReader table(
      file, {.header = support::CsvHeader::kOptional, .separator = support::CsvSeparator::kAny});
  std::vector<std::array<double, 3>> points;
  while (table.next_row()) {
    if (table.cells().size() < 3) {
      table.refuse("fewer than three values", "each row is x,y,z in metres");
    }
    points.push_back({table.number(0), table.number(1), table.number(2)});
  }
  return points;
}

}  // namespace tactree::cli
