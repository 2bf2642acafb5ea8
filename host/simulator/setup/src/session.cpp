#include "tactree/setup/session.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <utility>

#include "tactree/plant/vectors.hpp"
#include "tactree/setup/model_size.hpp"
#include "tactree/setup/path_file.hpp"
#include "tactree/simulation/hand_script.hpp"
#include "tactree/simulation/placement.hpp"
#include "tactree/simulation/workspace.hpp"
#include "tactree/support/device_file.hpp"
#include "tactree/support/explain.hpp"
#include "tactree/support/user_error.hpp"

namespace tactree::setup {
namespace {

using support::refuse;

/// Sets the device for controller and mechanics. Options take precedence over the device.
void choose_device(const SessionOptions& options, simulation::Setup& setup) {
  const support::Device device = support::load_device(options.device);
  simulation::use_device(device.preset, setup);
  if (options.force_max_N) {
    core::limit_force(setup.controller, *options.force_max_N);
  }
  if (setup.controller.device.kind != core::DeviceKind::kCartesian) {
    return;
  }
  for (float& counts : setup.controller.device.counts_per_m) {
    counts = static_cast<float>(1.0 / options.encoder_step_m);
  }
  if (device.name == "cartesian") {
    setup.dynamics.reset();  // uses mass and friction of the options
  }
}

core::Vec3 place_model(const SessionOptions& options, const FirstBody& body,
                       core::DeviceKind kind) {
  if (!options.origin_m.empty()) {
    return {static_cast<float>(options.origin_m[0]), static_cast<float>(options.origin_m[1]),
            static_cast<float>(options.origin_m[2])};
  }
  return body.in_device_frame ? core::Vec3{}
                              : simulation::middle_at_origin(body.view.header(), body.pose, kind);
}

[[noreturn]] void refuse_material(const std::string& file, const core::BlobView& view,
                                  const core::Configuration& controller) {
  const std::uint32_t index = core::find_unstable_material(view, controller);
  const core::BlobMaterial& material = view.material(index);
  refuse(
      fmt::format("{}: material {}", file, index),
      fmt::format("its stiffness of {:.6g} N/m is beyond the stability limit of {:.6g} N/m with a "
                  "hand at {:.6g} Hz",
                  material.stiffness_N_m, core::material_limit(controller, material),
                  controller.rate_hz),
      "build the blob with a softer or more damped --material, raise --rate, or simulate with "
      "--no-materials");
}

}  // namespace

simulation::HandPath hand_path(const SessionOptions& options, const FirstBody& body) {
  if (!options.path.empty()) {
    return read_path_file(options.path);
  }
  std::vector<simulation::Waypoint> waypoints =
      simulation::make_script(options.script, body.view, options.seconds).waypoints();
  for (simulation::Waypoint& waypoint : waypoints) {
    waypoint.position_m = body.pose * waypoint.position_m;
  }
  return simulation::HandPath(std::move(waypoints));
}

simulation::Setup make_setup(const SessionOptions& options, const FirstBody& body) {
  simulation::Setup setup = options.setup;
  core::Configuration& controller = setup.controller;
  controller.mode = options.mode == "paper" ? core::RenderMode::kPaper : core::RenderMode::kSurface;
  choose_device(options, setup);
  controller.model_origin_m = place_model(options, body, controller.device.kind);
  setup.board.encoders.latency_ticks = static_cast<std::uint32_t>(options.latency_ticks);
  controller.supervision.supply_monitored = true;
  controller.delay_s = static_cast<float>(options.latency_ticks) / controller.rate_hz;
  core::limit_to_rate(controller);
  if (options.first_force && core::check(controller) == core::ConfigurationStatus::kOk) {
    controller = core::first_force(controller);
  }
  return setup;
}

void check_start(const std::string& file, const core::BlobView& view,
                 const simulation::Setup& setup, const hal::StartResult& start) {
  if (start.configuration == core::ConfigurationStatus::kUnstable) {
    const core::StabilityLimit limit = core::stability_limit(setup.controller);
    refuse("--stiffness",
           fmt::format("{:.6g} N/m is beyond the stability limit of {:.6g} N/m with a hand at "
                       "{:.6g} Hz",
                       setup.controller.contact.stiffness_N_m, limit.with_hand_N_m,
                       setup.controller.rate_hz),
           "lower --stiffness, or raise --rate or --damping");
  }
  if (start.image != hal::ImageStatus::kOk) {
    refuse("the board does not start", describe(start),
           start.image == hal::ImageStatus::kBadMemory ? "replace the board"
                                                       : "build the image again");
  }
  if (start.configuration != core::ConfigurationStatus::kOk) {
    refuse("configuration", support::explain(core::refusal_of(setup.controller)),
           "give a value in that range");
  }
  if (start.blob != core::BlobStatus::kOk) {
    refuse(file, fmt::format("refused: {}", describe(start)), "build it again from the scan");
  }
  if (start.model == core::ModelStatus::kTooStiff) {
    refuse_material(file, view, setup.controller);
  }
  if (start.model != core::ModelStatus::kOk) {
    refuse(file, describe(start), "build it with --profile surface, or use --mode paper");
  }
}

void refuse_inactive(const std::string& device, const simulation::Setup& setup,
                     const simulation::Simulation& simulation) {
  const Eigen::Vector3d start =
      simulation.path().at(0.0).position_m + plant::widen(setup.controller.model_origin_m);
  if (!simulation::reaches_start(setup.controller.device, start)) {
    throw support::UserError(fmt::format(
        "{0} does not reach the start of the hand, and the probe is in the object (scale "
        "the model with build --fit device:{0}, or begin the path within the workspace)",
        device));
  }
  throw support::UserError(fmt::format(
      "the controller did not become active; its state is {} (begin the path outside the "
      "object)",
      core::name_of(simulation.state())));
}

nlohmann::json summary_json(const simulation::Summary& summary) {
  nlohmann::json faults = nlohmann::json::array();
  for (const simulation::FaultEvent& event : summary.faults) {
    faults.push_back({{"code", static_cast<int>(event.fault)},
                      {"name", core::name_of(event.fault)},
                      {"tick", event.tick}});
  }
  return {{"ticks", summary.ticks},
          {"contact_ticks", summary.contact_ticks},
          {"overruns", summary.overruns},
          {"force_max_N", summary.force_max_N},
          {"force_step_max_N", summary.force_step_max_N},
          {"penetration_max_m", summary.penetration_max_m},
          {"trace_crc32", summary.trace_crc32},
          {"faults", faults},
          {"crowded_ticks", summary.crowded_ticks}};
}

std::function<double(const Eigen::Vector3d&)> fit_to_device(const std::string& name) {
  const core::DeviceModel device = support::load_device(name).preset.model;
  return [device, name](const Eigen::Vector3d& size) {
    const std::optional<double> scale = fitting_scale(device, size);
    if (!scale) {
      refuse("--fit device:" + name, "the origin of the device is not inside its workspace",
             "correct the device");
    }
    return *scale * size.maxCoeff();
  };
}

}  // namespace tactree::setup
