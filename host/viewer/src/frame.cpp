#include "tactree/viewer/frame.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "fault_advice.hpp"
#include "tactree/plant/linkage.hpp"
#include "tactree/plant/linkage_shape.hpp"
#include "tactree/plant/vectors.hpp"
#include "tactree/simulation/workspace.hpp"

namespace tactree::viewer {
namespace {

using nlohmann::json;
using plant::widen;

// For drawing only, where a micrometre is less than a pixel.
double rounded(double metres) { return std::round(1e6 * metres) * 1e-6; }

json drawn(const Eigen::Vector3d& v) {
  return json::array({rounded(v.x()), rounded(v.y()), rounded(v.z())});
}

// Displayed values keep all digits, because they must match the trace.
json exact(core::Vec3 v) { return json::array({v.x, v.y, v.z}); }

json faults_json(core::FaultMask mask) {
  json faults = json::array();
  for (std::uint32_t code = 1; code < core::kFaultCodes; ++code) {
    const auto fault = static_cast<core::Fault>(code);
    if (core::has_fault(mask, fault)) {
      faults.push_back(
          {{"code", code}, {"name", core::name_of(fault)}, {"about", fault_advice(fault)}});
    }
  }
  return faults;
}

json limits_json(core::LimitMask mask) {
  json limits = json::array();
  for (std::uint32_t bit = 0; bit < core::kLimits; ++bit) {
    if ((mask >> bit & 1U) != 0U) {
      limits.push_back(core::name_of(static_cast<core::Limit>(1U << bit)));
    }
  }
  return limits;
}

json linkage_json(const core::DeviceModel& device, const core::Vec3& origin_m,
                  const Eigen::Vector3d& tip_m, const std::optional<Eigen::Vector3d>& known) {
  const plant::Linkage linkage(device);
  const Eigen::Vector3d tip = tip_m + widen(origin_m);
  const Eigen::Vector3d joints = known ? *known : linkage.joints_near(tip);
  json lines = json::array();
  for (const plant::Polyline& line : plant::linkage_shape(device, joints, tip)) {
    json points = json::array();
    for (const Eigen::Vector3d& point : line) {
      points.push_back(drawn(point - widen(origin_m)));
    }
    lines.push_back(std::move(points));
  }
  return lines;
}

/// The points to which the surface at the proxy is fitted.
json candidates_json(const core::Rendering& rendering, const Bodies& bodies, const core::Pose& pose,
                     core::CandidateSet& scratch) {
  const core::BlobView& view = bodies.views[rendering.body];
  const core::Vec3 centre = core::position_to_body(pose, rendering.proxy);
  scratch.clear();
  scratch.cover(view, centre);
  json points = json::array();
  for (const core::Candidate& candidate : scratch) {
    const core::Vec3 offset = candidate.position - centre;
    if (core::dot(offset, offset) <=
        view.header().support_radius_m * view.header().support_radius_m) {
      points.push_back(drawn(widen(core::position_to_scene(pose, candidate.position))));
    }
  }
  return points;
}

}  // namespace

void Span::add(double value) {
  low = empty ? value : std::min(low, value);
  high = empty ? value : std::max(high, value);
  empty = false;
}

void Strip::add(const core::Status& status) {
  force_N_.add(static_cast<double>(core::length(status.force)));
  const core::Rendering& r = status.rendering;
  penetration_m_.add(r.in_contact ? static_cast<double>(r.penetration_m) : 0.0);
  ++ticks_;
}

json Strip::take() {
  const auto pair = [](const Span& span) {
    return span.empty ? json() : json::array({span.low, span.high});
  };
  json taken = {{"ticks", ticks_},
                {"force_N", pair(force_N_)},
                {"penetration_m", pair(penetration_m_)},
                {"work", pair(work_)}};
  *this = {};
  return taken;
}

json run_json(const simulation::Sample& sample, const char* mode, const core::DeviceModel& device,
              const core::Vec3& model_origin_m, const std::optional<Eigen::Vector3d>& joints,
              const Bodies& bodies, core::CandidateSet& scratch) {
  const core::Status& s = sample.status;
  const core::Rendering& r = s.rendering;
  json run = {{"mode", mode},
              {"state", core::name_of(s.state)},
              {"faults", faults_json(s.faults)},
              {"limits", limits_json(s.limits)},
              {"overruns", s.overruns},
              {"t_s", sample.t_s},
              {"probe_m", exact(s.probe)},
              {"proxy_m", exact(r.in_contact ? r.proxy : s.probe)},
              {"normal", exact(r.normal)},
              {"force_N", exact(s.force)},
              {"velocity_m_s", exact(s.velocity)},
              {"penetration_m", r.in_contact ? r.penetration_m : 0.0F},
              {"in_contact", r.in_contact},
              {"slipping", r.slipping},
              {"strength", r.strength},
              {"note", ""},
              {"tip_m", json::array({sample.tip_m.x(), sample.tip_m.y(), sample.tip_m.z()})},
              {"linkage", linkage_json(device, model_origin_m, sample.tip_m, joints)},
              {"candidates", json::array()}};
  if (sample.has_parts) {
    run["motor_force_N"] = exact(s.motor_force);
    run["gravity_force_N"] = exact(s.gravity_force);
    run["added_force_N"] = exact(s.added_force);
  }
  if (r.in_contact && r.body < bodies.views.size()) {
    const core::Pose pose = bodies.bodies[r.body].path.at(sample.t_s).pose;
    run["candidates"] = candidates_json(r, bodies, pose, scratch);
  }
  return run;
}

json work_json(const Work& work) {
  return {
      {"unit", work.unit}, {"bound", work.bound ? json(*work.bound) : json()}, {"why", work.why}};
}

json unknown_work(const std::string& why) { return work_json({{}, 0.0, std::nullopt, why}); }

json models_json(const Bodies& bodies) {
  json models = json::array();
  for (const core::BlobView& view : bodies.views) {
    const std::size_t index = models.size();
    models.push_back({{"name", view.header().name},
                      {"points", view.point_count()},
                      {"note", index < bodies.notes.size() ? bodies.notes[index] : ""}});
  }
  return models;
}

bool has_materials(const Bodies& bodies) {
  return std::any_of(bodies.views.begin(), bodies.views.end(),
                     [](const core::BlobView& view) { return view.material_count() > 0; });
}

json poses_json(const Bodies& bodies, double t_s) {
  json poses = json::array();
  for (const simulation::SceneBody& body : bodies.bodies) {
    const core::Pose pose = body.path.at(t_s).pose;
    const Eigen::Quaterniond turn(
        static_cast<double>(pose.rotation.w), static_cast<double>(pose.rotation.v.x),
        static_cast<double>(pose.rotation.v.y), static_cast<double>(pose.rotation.v.z));
    const Eigen::Matrix3d m = turn.normalized().toRotationMatrix();
    const Eigen::Vector3d t = widen(pose.translation_m);
    json rows = json::array();
    for (Eigen::Index row = 0; row < 3; ++row) {
      rows.insert(rows.end(), {m(row, 0), m(row, 1), m(row, 2), t[row]});
    }
    poses.push_back(std::move(rows));
  }
  return poses;
}

std::string reach_json(const core::DeviceModel& device) {
  const simulation::ReachShape shape = simulation::reach_shape(device);
  json points = json::array();
  for (const Eigen::Vector3d& point : shape.points_m) {
    points.push_back(drawn(point));
  }
  return json{{"rows", shape.rows}, {"columns", shape.columns}, {"points_m", std::move(points)}}
      .dump();
}

}  // namespace tactree::viewer
