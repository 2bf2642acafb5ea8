#include <fmt/format.h>

#include <array>
#include <limits>
#include <optional>
#include <string>
#include <string_view>

#include "tactree/support/csv.hpp"
#include "tactree/viewer/trace_playback.hpp"

namespace tactree::viewer {
namespace {

using simulation::Sample;
using support::CsvReader;
using Column = std::optional<std::size_t>;

// Maximum length of a trace that `tactree simulate` writes.
constexpr std::size_t kMaxTicks = 5000000;
constexpr const char* kRemedy = "give a file written by simulate --trace";

std::size_t required(const support::CsvReader& table, const std::string& name) {
  const Column column = table.find_column(name);
  if (!column) {
    table.refuse("the header has no column " + name, kRemedy);
  }
  return *column;
}

/// The columns of a vector: NAME_xUNIT, NAME_yUNIT, NAME_zUNIT.
struct VectorColumns {
  VectorColumns(const support::CsvReader& table, const std::string& name, const std::string& unit) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      axes[axis] = table.find_column(fmt::format("{}_{}{}", name, "xyz"[axis], unit));
    }
  }
  std::array<Column, 3> axes;
};

struct Columns {
  explicit Columns(const support::CsvReader& table)
      : t_s(required(table, "t_s")),
        tip(table, "tip", "_m"),
        probe(table, "probe", "_m"),
        velocity(table, "velocity", "_m_s"),
        force(table, "force", "_N"),
        proxy(table, "proxy", "_m"),
        normal(table, "normal", ""),
        state(table.find_column("state")),
        limits(table.find_column("limits")),
        faults(table.find_column("faults")),
        in_contact(table.find_column("in_contact")),
        slipping(table.find_column("slipping")),
        penetration_m(table.find_column("penetration_m")),
        strength(table.find_column("strength")),
        body(table.find_column("body")) {
    for (const char* name :
         {"probe_x_m", "probe_y_m", "probe_z_m", "force_x_N", "force_y_N", "force_z_N"}) {
      (void)required(table, name);
    }
  }

  std::size_t t_s;
  VectorColumns tip, probe, velocity, force, proxy, normal;
  Column state, limits, faults, in_contact, slipping, penetration_m, strength, body;
};

/// The current row. Values of missing columns are 0.
class Row {
 public:
  explicit Row(const support::CsvReader& table) : table_(table) {}

  [[nodiscard]] std::string_view text(Column column) const {
    return column ? table_.cells()[*column] : std::string_view();
  }
  [[nodiscard]] double number(Column column) const { return column ? table_.number(*column) : 0.0; }
  [[nodiscard]] float narrow(Column column) const { return static_cast<float>(number(column)); }
  [[nodiscard]] std::uint32_t index(Column column, std::uint32_t none) const {
    const double value = number(column);
    const bool known = column && value >= 0.0 && value <= std::numeric_limits<std::uint32_t>::max();
    return known ? static_cast<std::uint32_t>(value) : none;
  }
  [[nodiscard]] core::Vec3 vector(const VectorColumns& columns) const {
    return {narrow(columns.axes[0]), narrow(columns.axes[1]), narrow(columns.axes[2])};
  }
  [[nodiscard]] Eigen::Vector3d wide_vector(const VectorColumns& columns) const {
    return {number(columns.axes[0]), number(columns.axes[1]), number(columns.axes[2])};
  }

 private:
  const support::CsvReader& table_;
};

core::State state_of(std::string_view name) {
  for (std::uint32_t i = 0; i < core::kStates; ++i) {
    if (name == core::name_of(static_cast<core::State>(i))) {
      return static_cast<core::State>(i);
    }
  }
  return core::State::kBoot;
}

Sample read_sample(const Row& row, const Columns& columns) {
  Sample sample;
  sample.has_parts = false;
  sample.t_s = row.number(columns.t_s);
  // Boards do not report the true position of the tip; the probe is used instead.
  sample.tip_m = row.wide_vector(columns.tip.axes[0] ? columns.tip : columns.probe);
  core::Status& s = sample.status;
  s.probe = row.vector(columns.probe);
  s.velocity = row.vector(columns.velocity);
  s.force = row.vector(columns.force);
  s.state = state_of(row.text(columns.state));
  s.limits = row.index(columns.limits, 0);
  s.faults = row.index(columns.faults, 0);
  core::Rendering& r = s.rendering;
  r.in_contact = row.number(columns.in_contact) != 0.0;
  r.slipping = row.number(columns.slipping) != 0.0;
  r.proxy = row.vector(columns.proxy);
  r.normal = row.vector(columns.normal);
  r.penetration_m = row.narrow(columns.penetration_m);
  r.strength = row.narrow(columns.strength);
  r.body = row.index(columns.body, core::kNoBody);
  return sample;
}

}  // namespace

std::vector<Sample> read_trace(const std::filesystem::path& file) {
  support::CsvReader table(file, {.header = support::CsvHeader::kRequired});
  if (table.columns().empty()) {
    table.refuse("the trace has no ticks", kRemedy);
  }
  const Columns columns(table);
  const Row row(table);
  std::vector<Sample> samples;
  while (table.next_row()) {
    samples.push_back(read_sample(row, columns));
    if (samples.size() > 1 && !(samples.back().t_s > samples[samples.size() - 2].t_s)) {
      table.refuse("t_s does not increase", kRemedy);
    }
    if (samples.size() > kMaxTicks) {
      table.refuse(fmt::format("more than {} ticks", kMaxTicks), "record a shorter run");
    }
  }
  if (samples.empty()) {
    table.refuse("the trace has no ticks", kRemedy);
  }
  return samples;
}

}  // namespace tactree::viewer
