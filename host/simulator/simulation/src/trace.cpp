#include "tactree/simulation/trace.hpp"

#include <fmt/format.h>

#include <iterator>

namespace tactree::simulation {
namespace {

/// Calls `visit(name, type, value)` for each column. The only list of the columns.
template <class Visit>
void visit_columns(const Sample& sample, Visit visit) {
  using enum TraceType;
  const core::Status& s = sample.status;
  const core::Rendering& r = s.rendering;
  const auto vector = [&](const std::string& name, const char* unit, core::Vec3 v) {
    visit(name + "_x" + unit, kFloat32, static_cast<double>(v.x));
    visit(name + "_y" + unit, kFloat32, static_cast<double>(v.y));
    visit(name + "_z" + unit, kFloat32, static_cast<double>(v.z));
  };
  visit("t_s", kFloat64, sample.t_s);
  vector("probe", "_m", s.probe);
  vector("proxy", "_m", r.in_contact ? r.proxy : s.probe);
  vector("force", "_N", s.force);
  visit("in_contact", kFlag, r.in_contact ? 1.0 : 0.0);
  visit("state", kState, static_cast<double>(s.state));
  vector("normal", "", r.normal);
  visit("penetration_m", kFloat32, static_cast<double>(r.penetration_m));
  vector("velocity", "_m_s", s.velocity);
  visit("tip_x_m", kFloat64, sample.tip_m.x());
  visit("tip_y_m", kFloat64, sample.tip_m.y());
  visit("tip_z_m", kFloat64, sample.tip_m.z());
  visit("slipping", kFlag, r.slipping ? 1.0 : 0.0);
  visit("strength", kFloat32, static_cast<double>(r.strength));
  visit("limits", kUint32, static_cast<double>(s.limits));
  visit("faults", kUint32, static_cast<double>(s.faults));
  visit("body", kInt32, r.in_contact ? static_cast<double>(r.body) : -1.0);
}

void append_value(std::string& csv, TraceType type, double value) {
  auto to = std::back_inserter(csv);
  if (type == TraceType::kFloat64 || type == TraceType::kFloat32) {
    fmt::format_to(to, "{:.9g}", value);
  } else if (type == TraceType::kState) {
    fmt::format_to(to, "{}", core::name_of(static_cast<core::State>(value)));
  } else {
    fmt::format_to(to, "{}", static_cast<std::int64_t>(value));
  }
}

}  // namespace

const std::vector<TraceColumn>& trace_columns() {
  static const std::vector<TraceColumn> kColumns = [] {
    std::vector<TraceColumn> list;
    visit_columns(Sample{}, [&](const std::string& name, TraceType type, double) {
      list.push_back({name, type});
    });
    return list;
  }();
  return kColumns;
}

void trace_values(const Sample& sample, std::vector<double>& values) {
  values.clear();
  visit_columns(sample,
                [&](const std::string&, TraceType, double value) { values.push_back(value); });
}

std::string trace_heading(bool with_panel) {
  std::string csv;
  for (const TraceColumn& column : trace_columns()) {
    csv += (csv.empty() ? "" : ",") + column.name;
  }
  return csv + (with_panel ? ",button,lamp\n" : "\n");
}

void append_trace(std::string& csv, const Sample& sample, bool with_panel) {
  bool first = true;
  visit_columns(sample, [&](const std::string&, TraceType type, double value) {
    if (!first) {
      csv += ',';
    }
    first = false;
    append_value(csv, type, value);
  });
  if (with_panel) {
    fmt::format_to(std::back_inserter(csv), ",{:d},{:d}", sample.button, sample.lamp);
  }
  csv += '\n';
}

}  // namespace tactree::simulation
