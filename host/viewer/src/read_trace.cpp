#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <fstream>
#include <limits>
#include <map>
#include <stdexcept>
#include <string_view>

#include "csv.hpp"
#include "tactree/viewer/recording.hpp"

namespace tactree::viewer {
namespace {

using simulation::Sample;

// As many samples as simulate writes at most.
constexpr std::size_t kMostTicks = 5000000;

/// One row, by the names of its columns.
class Row {
 public:
  Row(const std::map<std::string, std::size_t>& columns, std::vector<std::string_view> cells)
      : columns_(columns), cells_(std::move(cells)) {}

  [[nodiscard]] std::string_view text(const std::string& column) const {
    const auto found = columns_.find(column);
    return found == columns_.end() ? std::string_view() : cells_[found->second];
  }
  /// 0 where there is no such column.
  [[nodiscard]] double number(const std::string& column) const {
    const std::string_view digits = text(column);
    if (columns_.count(column) == 0) {
      return 0.0;
    }
    double value = 0.0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (error != std::errc() || end != digits.data() + digits.size() || !std::isfinite(value)) {
      throw std::runtime_error(fmt::format("{}: '{}' is not a number", column, digits));
    }
    return value;
  }
  [[nodiscard]] float narrow(const std::string& column) const {
    return static_cast<float>(number(column));
  }
  [[nodiscard]] std::uint32_t index(const std::string& column, std::uint32_t none) const {
    const double value = number(column);
    const bool known = columns_.count(column) != 0 && value >= 0.0 &&
                       value <= std::numeric_limits<std::uint32_t>::max();
    return known ? static_cast<std::uint32_t>(value) : none;
  }
  /// "NAME_x_UNIT" and so on.
  [[nodiscard]] core::Vec3 vector(const std::string& name, const std::string& unit) const {
    return {narrow(name + "_x" + unit), narrow(name + "_y" + unit), narrow(name + "_z" + unit)};
  }

 private:
  const std::map<std::string, std::size_t>& columns_;
  std::vector<std::string_view> cells_;
};

core::State state_of(std::string_view name) {
  for (std::uint32_t i = 0; i < core::kStates; ++i) {
    if (name == core::name_of(static_cast<core::State>(i))) {
      return static_cast<core::State>(i);
    }
  }
  return core::State::kBoot;
}

Sample sample_of(const Row& row) {
  Sample sample;
  sample.t_s = row.number("t_s");
  sample.tip_m = {row.number("tip_x_m"), row.number("tip_y_m"), row.number("tip_z_m")};
  core::Status& s = sample.status;
  s.probe = row.vector("probe", "_m");
  s.velocity = row.vector("velocity", "_m_s");
  s.force = row.vector("force", "_N");
  s.state = state_of(row.text("state"));
  s.limits = row.index("limits", 0);
  s.faults = row.index("faults", 0);
  core::Rendering& r = s.rendering;
  r.in_contact = row.number("in_contact") != 0.0;
  r.slipping = row.number("slipping") != 0.0;
  r.proxy = row.vector("proxy", "_m");
  r.normal = row.vector("normal", "");
  r.penetration_m = row.narrow("penetration_m");
  r.strength = row.narrow("strength");
  r.body = row.index("body", core::kNoBody);
  return sample;
}

std::map<std::string, std::size_t> columns_of(const std::string& heading) {
  std::map<std::string, std::size_t> columns;
  const std::vector<std::string_view> names = cells_of(heading);
  for (std::size_t i = 0; i < names.size(); ++i) {
    columns.emplace(names[i], i);
  }
  for (const char* needed :
       {"t_s", "probe_x_m", "probe_y_m", "probe_z_m", "force_x_N", "force_y_N", "force_z_N"}) {
    if (columns.count(needed) == 0) {
      throw std::runtime_error(fmt::format("the heading has no column {}", needed));
    }
  }
  return columns;
}

Sample read_row(const std::map<std::string, std::size_t>& columns, const std::string& line) {
  std::vector<std::string_view> cells = cells_of(line);
  if (cells.size() != columns.size()) {
    throw std::runtime_error(
        fmt::format("{} values, the heading has {}", cells.size(), columns.size()));
  }
  Sample sample = sample_of(Row(columns, std::move(cells)));
  if (columns.count("tip_x_m") == 0) {
    const core::Vec3 p = sample.status.probe;
    sample.tip_m = {static_cast<double>(p.x), static_cast<double>(p.y), static_cast<double>(p.z)};
  }
  return sample;
}

}  // namespace

std::vector<Sample> read_trace(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::size_t number = 0;
  const auto refuse = [&](const std::string& cause) -> std::runtime_error {
    return std::runtime_error(fmt::format(
        "{}: line {}: {} (give a file that simulate --trace wrote)", file.string(), number, cause));
  };
  if (!in) {
    throw std::runtime_error(
        fmt::format("{}: it cannot be read (check name and rights)", file.string()));
  }
  std::vector<Sample> samples;
  std::map<std::string, std::size_t> columns;
  std::string line;
  try {
    while (std::getline(in, line)) {
      ++number;
      if (!line.empty() && line.back() == '\r') {
        line.pop_back();
      }
      if (number == 1) {
        columns = columns_of(line);
        continue;
      }
      samples.push_back(read_row(columns, line));
      if (samples.size() > 1 && !(samples.back().t_s > samples[samples.size() - 2].t_s)) {
        throw std::runtime_error("t_s does not ascend");
      }
      if (samples.size() > kMostTicks) {
        throw std::runtime_error(fmt::format("more than {} ticks", kMostTicks));
      }
    }
  } catch (const std::runtime_error& error) {
    throw refuse(error.what());
  }
  if (samples.empty()) {
    throw refuse("there is no tick");
  }
  return samples;
}

}  // namespace tactree::viewer
