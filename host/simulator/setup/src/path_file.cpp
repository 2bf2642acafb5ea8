#include "tactree/setup/path_file.hpp"

#include <fmt/format.h>

#include <array>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "tactree/support/csv.hpp"

namespace tactree::setup {
namespace {

// Waypoints of one hour at 10 kHz.
constexpr std::size_t kMaxWaypoints = 36'000'000;

/// The columns of time, x, y and z: the first four without a line of names.
std::array<std::size_t, 4> columns_of(const support::CsvReader& table) {
  std::array<std::size_t, 4> columns{0, 1, 2, 3};
  if (table.columns().empty()) {
    return columns;
  }
  constexpr std::string_view kNames[4][3] = {
      {"t_s", "t", "time_s"}, {"x", "x_m", "X"}, {"y", "y_m", "Y"}, {"z", "z_m", "Z"}};
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const std::optional<std::size_t> found = table.find_column(kNames[i]);
    if (!found) {
      table.refuse("the names of the columns do not include t_s, x, y and z",
                   "name them, in seconds and metres, or omit the line of names");
    }
    columns[i] = *found;
  }
  return columns;
}

}  // namespace

simulation::HandPath read_path_file(const std::filesystem::path& file) {
  support::CsvReader table(
      file, {.header = support::CsvHeader::kOptional, .separator = support::CsvSeparator::kAny});
  const auto [t, x, y, z] = columns_of(table);
  const std::size_t width = table.columns().empty() ? 4 : table.columns().size();
  std::vector<simulation::Waypoint> waypoints;
  while (table.next_row()) {
    if (table.cells().size() != width) {
      table.refuse(fmt::format("{} values instead of {}", table.cells().size(), width),
                   "each row is t_s,x,y,z in seconds and metres, or has a value for each name");
    }
    const simulation::Waypoint next{table.number(t),
                                    {table.number(x), table.number(y), table.number(z)}};
    if (!waypoints.empty() && !(next.t_s > waypoints.back().t_s)) {
      table.refuse("the time does not ascend", "sort the rows by t_s");
    }
    if (waypoints.size() == kMaxWaypoints) {
      table.refuse("too many rows", "use fewer waypoints");
    }
    waypoints.push_back(next);
  }
  if (waypoints.empty()) {
    throw support::CsvError(file.string() + ": has no waypoint (write rows t_s,x,y,z)");
  }
  return simulation::HandPath(std::move(waypoints));
}

}  // namespace tactree::setup
