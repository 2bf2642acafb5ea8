#include "tactree/telemetry/tick_table.hpp"

#include <algorithm>
#include <array>
#include <limits>

#include "tactree/core/control/controller.hpp"
#include "tactree/core/link/wire/frame.hpp"

namespace tactree::telemetry {
namespace {

// Differences of the board's clock beyond this are negative.
constexpr std::uint32_t kHalf = 0x80000000U;
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

std::vector<std::string> state_names() {
  std::vector<std::string> names;
  for (std::uint32_t i = 0; i < core::kStates; ++i) {
    names.emplace_back(core::name_of(static_cast<core::State>(i)));
  }
  return names;
}

bool has_parts(std::uint32_t fields) {
  return (fields & static_cast<std::uint32_t>(core::wire::TelemetryField::kParts)) != 0U;
}

/// Calls `visit(name, type, value)` for each column. The only list of the columns.
template <class Visit>
void visit_columns(const Tick& tick, std::uint32_t fields, Visit visit) {
  using enum ColumnType;
  const core::wire::Telemetry& t = tick.telemetry;
  const bool in_contact = t.body != core::kNoBody;
  const auto number = [&](const std::string& name, float value) {
    visit(name, kFloat32, static_cast<double>(value));
  };
  const auto vector = [&](const std::string& name, const std::string& unit, const float(&v)[3]) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      number(name + "_" + "xyz"[axis] + unit, v[axis]);
    }
  };
  visit("t_s", kFloat64, static_cast<double>(tick.time_us) / 1e6);
  visit("tick", kUint32, t.header.tick);
  visit("missing_ticks", kUint32, tick.missing_ticks);
  visit("state", kUint8, std::min(t.state, core::kStates - 1U));
  visit("faults", kUint32, t.faults);
  visit("limits", kUint32, t.limits);
  vector("probe", "_m", t.probe_m);
  vector("velocity", "_m_s", t.velocity_m_s);
  vector("force", "_N", t.force_N);
  vector("wanted_force", "_N", t.wanted_N);
  const auto part = [&](const std::string& name, const float(&v)[3]) {
    constexpr float kUnknown[3] = {kNan, kNan, kNan};
    if (has_parts(fields)) {
      vector(name, "_N", has_parts(t.header.fields) ? v : kUnknown);
    }
  };
  part("gravity_force", t.gravity_N);
  part("added_force", t.added_N);
  part("motor_force", t.motors_N);
  visit("in_contact", kUint8, in_contact ? 1.0 : 0.0);
  visit("body", kInt32, in_contact ? static_cast<double>(t.body) : -1.0);
  vector("proxy", "_m", in_contact ? t.proxy_m : t.probe_m);
  vector("normal", "", t.normal);
  number("penetration_m", t.penetration_m);
  number("strength", t.strength);
  visit("overruns", kUint32, t.overruns);
  number("load", t.load);
}

}  // namespace

std::optional<Tick> TickSequence::next(const core::wire::Telemetry& telemetry) {
  Tick tick;
  if (begun_) {
    const std::uint32_t since_us = telemetry.header.board_time_us - last_.board_time_us;
    const std::uint32_t ticks = telemetry.header.tick - last_.tick;
    if (since_us == 0U || since_us >= kHalf || ticks == 0U || ticks >= kHalf) {
      return std::nullopt;
    }
    time_us_ += since_us;
    tick.missing_ticks = std::max(ticks / every_ticks_, 1U) - 1U;
  }
  begun_ = true;
  last_ = telemetry.header;
  tick.time_us = time_us_;
  tick.telemetry = telemetry;
  return tick;
}

std::size_t bytes_of(ColumnType type) {
  constexpr std::array<std::size_t, 5> kBytes = {8, 4, 4, 4, 1};
  return kBytes[static_cast<std::size_t>(type)];
}

std::size_t frame_bytes(std::uint32_t fields) {
  std::size_t bytes = sizeof(core::wire::FrameHeader) + sizeof(core::wire::TelemetryHeader) +
                      core::wire::kFrameChecksumBytes;
  for (std::uint32_t i = 0; i < core::wire::kTelemetryFields; ++i) {
    bytes += (fields >> i & 1U) * core::wire::kTelemetryFieldBytes[i];
  }
  return bytes + 1 + bytes / 254 + 1;  // COBS, and the delimiter
}

std::vector<Column> columns_of(std::uint32_t fields) {
  std::vector<Column> list;
  visit_columns({}, fields, [&](const std::string& name, ColumnType type, double) {
    list.push_back({name, type, name == "state" ? state_names() : std::vector<std::string>{}});
  });
  return list;
}

const std::vector<Column>& columns() {
  static const std::vector<Column> kColumns = columns_of(kRecordedFields);
  return kColumns;
}

void values_of(const Tick& tick, std::vector<double>& values, std::uint32_t fields) {
  values.clear();
  visit_columns(tick, fields,
                [&](const std::string&, ColumnType, double value) { values.push_back(value); });
}

}  // namespace tactree::telemetry
