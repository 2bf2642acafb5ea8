#include "tactree/simulation/hand_path.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <iterator>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>

#include "number_text.hpp"

namespace tactree::simulation {
namespace {

// Waypoints of one hour at 10 kHz.
constexpr std::size_t kMaxWaypoints = 36'000'000;

[[noreturn]] void refuse(const std::filesystem::path& file, std::size_t line, const char* what) {
  throw std::runtime_error(file.string() + ": line " + std::to_string(line) + ": " + what);
}

std::string_view trimmed(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(" \t\r");
  if (begin == std::string_view::npos) {
    return {};
  }
  return text.substr(begin, text.find_last_not_of(" \t\r") - begin + 1);
}

/// Waypoint of a row with four numbers; empty if the row has any other content.
std::optional<Waypoint> waypoint(std::string_view row) {
  std::array<double, 4> values{};
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::size_t comma = row.find(',');
    if ((comma == std::string_view::npos) != (i + 1 == values.size())) {
      return std::nullopt;
    }
    const std::optional<double> value = parse_number(trimmed(row.substr(0, comma)));
    if (!value) {
      return std::nullopt;
    }
    values[i] = *value;
    row = comma == std::string_view::npos ? std::string_view{} : row.substr(comma + 1);
  }
  return Waypoint{values[0], {values[1], values[2], values[3]}};
}

/// True for t_s,x,y,z, also as t,x_m,y_m,z_m.
bool names_columns(std::string_view row) {
  constexpr std::string_view kNames[4][3] = {
      {"t_s", "t", "time_s"}, {"x", "x_m", "X"}, {"y", "y_m", "Y"}, {"z", "z_m", "Z"}};
  for (const auto& names : kNames) {
    const std::size_t comma = row.find(',');
    if (std::find(std::begin(names), std::end(names), trimmed(row.substr(0, comma))) ==
        std::end(names)) {
      return false;
    }
    row = comma == std::string_view::npos ? std::string_view{} : row.substr(comma + 1);
  }
  return true;
}

}  // namespace

HandPath::HandPath(std::vector<Waypoint> waypoints) : waypoints_(std::move(waypoints)) {
  if (waypoints_.empty()) {
    throw std::invalid_argument("a hand's path needs at least one waypoint");
  }
  for (std::size_t i = 0; i < waypoints_.size(); ++i) {
    const Waypoint& w = waypoints_[i];
    if (!std::isfinite(w.t_s) || !w.position_m.allFinite()) {
      throw std::invalid_argument("a waypoint is not finite");
    }
    if (i > 0 && !(w.t_s > waypoints_[i - 1].t_s)) {
      throw std::invalid_argument("the time of the waypoints does not ascend");
    }
  }
}

plant::HandTarget HandPath::at(double t_s) const {
  const auto after = std::upper_bound(waypoints_.begin(), waypoints_.end(), t_s,
                                      [](double t, const Waypoint& w) { return t < w.t_s; });
  if (after == waypoints_.begin()) {
    return {waypoints_.front().position_m, Eigen::Vector3d::Zero()};
  }
  if (after == waypoints_.end()) {
    return {waypoints_.back().position_m, Eigen::Vector3d::Zero()};
  }
  const Waypoint& before = *std::prev(after);
  const Eigen::Vector3d velocity =
      (after->position_m - before.position_m) / (after->t_s - before.t_s);
  return {before.position_m + (t_s - before.t_s) * velocity, velocity};
}

HandPath read_hand_path(const std::filesystem::path& file) {
  std::ifstream in(file);
  if (!in) {
    throw std::runtime_error(file.string() +
                             ": cannot be read (check the path and its permissions)");
  }
  std::vector<Waypoint> waypoints;
  std::string line;
  bool heading_allowed = true;
  for (std::size_t number_of_line = 1; std::getline(in, line); ++number_of_line) {
    const std::string_view row = trimmed(line);
    if (row.empty() || row.front() == '#') {
      continue;
    }
    const std::optional<Waypoint> next = waypoint(row);
    if (!next && !heading_allowed) {
      refuse(file, number_of_line, "is not four numbers (write t_s,x,y,z in seconds and metres)");
    }
    if (!next && !names_columns(row)) {
      refuse(file, number_of_line,
             "names other columns than t_s,x,y,z in seconds and metres (write these)");
    }
    heading_allowed = false;
    if (!next) {
      continue;
    }
    if (!waypoints.empty() && !(next->t_s > waypoints.back().t_s)) {
      refuse(file, number_of_line, "the time does not ascend (sort the rows by t_s)");
    }
    if (waypoints.size() == kMaxWaypoints) {
      refuse(file, number_of_line, "too many rows (use fewer waypoints)");
    }
    waypoints.push_back(*next);
  }
  if (waypoints.empty()) {
    throw std::runtime_error(file.string() + ": has no waypoint (write rows t_s,x,y,z)");
  }
  return HandPath(std::move(waypoints));
}

}  // namespace tactree::simulation
