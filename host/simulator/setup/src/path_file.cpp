#include "tactree/setup/path_file.hpp"

#include <fmt/format.h>

#include <array>
#include <string_view>
#include <utility>
#include <vector>

#include "tactree/support/csv.hpp"

namespace tactree::setup {
namespace {

// Waypoints of one hour at 10 kHz.
constexpr std::size_t kMaxWaypoints = 36'000'000;

constexpr std::array<std::string_view, 3> kColumns[4] = {
    {"t_s", "t", "time_s"}, {"x", "x_m", "X"}, {"y", "y_m", "Y"}, {"z", "z_m", "Z"}};

}  // namespace

simulation::HandPath read_path_file(const std::filesystem::path& file) {
  support::CsvReader table(
      file, {.header = support::CsvHeader::kOptional, .separator = support::CsvSeparator::kAny});
  const std::vector<std::size_t> columns =
      table.find_columns(kColumns, "name them, in seconds and metres, or omit the line of names");
  const std::size_t width = table.columns().empty() ? columns.size() : table.columns().size();
  std::vector<simulation::Waypoint> waypoints;
  while (table.next_row()) {
    if (table.cells().size() != width) {
      table.refuse(fmt::format("{} values instead of {}", table.cells().size(), width),
                   "each row is t_s,x,y,z in seconds and metres, or has a value for each name");
    }
    const simulation::Waypoint next{
        table.number(columns[0]),
        {table.number(columns[1]), table.number(columns[2]), table.number(columns[3])}};
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
