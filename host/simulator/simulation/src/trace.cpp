#include "tactree/simulation/trace.hpp"

#include <fmt/format.h>

#include <iterator>

namespace tactree::simulation {
namespace {

void append(std::string& csv, core::Vec3 v) {
  fmt::format_to(std::back_inserter(csv), ",{:.9g},{:.9g},{:.9g}", v.x, v.y, v.z);
}

}  // namespace

std::string trace_heading() {
  return "t_s,probe_x_m,probe_y_m,probe_z_m,proxy_x_m,proxy_y_m,proxy_z_m,"
         "force_x_N,force_y_N,force_z_N,in_contact,state,"
         "normal_x,normal_y,normal_z,penetration_m,velocity_x_m_s,velocity_y_m_s,velocity_z_m_s,"
         "tip_x_m,tip_y_m,tip_z_m,slipping,strength,limits,faults,body\n";
}

void append_trace(std::string& csv, const Sample& sample) {
  const core::Status& s = sample.status;
  const core::Rendering& r = s.rendering;
  fmt::format_to(std::back_inserter(csv), "{:.9g}", sample.t_s);
  append(csv, s.probe);
  append(csv, r.in_contact ? r.proxy : s.probe);
  append(csv, s.force);
  fmt::format_to(std::back_inserter(csv), ",{:d},{}", r.in_contact, core::name_of(s.state));
  append(csv, r.normal);
  fmt::format_to(std::back_inserter(csv), ",{:.9g}", r.penetration_m);
  append(csv, s.velocity);
  fmt::format_to(std::back_inserter(csv), ",{:.9g},{:.9g},{:.9g},{:d},{:.9g},{},{},{}\n",
                 sample.tip_m.x(), sample.tip_m.y(), sample.tip_m.z(), r.slipping, r.strength,
                 s.limits, s.faults, r.in_contact ? static_cast<std::int64_t>(r.body) : -1);
}

}  // namespace tactree::simulation
