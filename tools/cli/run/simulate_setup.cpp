#include "run/simulate_setup.hpp"

#include <fmt/format.h>

#include <cmath>

#include "image/board_costs.hpp"
#include "tactree/simulation/hand_script.hpp"
#include "tactree/simulation/placement.hpp"
#include "tactree/support/device_file.hpp"
#include "tactree/support/explain.hpp"
#include "tactree/support/user_error.hpp"

namespace tactree::cli {
namespace {

/// Sets the device for controller and mechanics. Options take precedence over the device.
void choose_device(const SimulateOptions& options, simulation::Setup& setup) {
  const support::Device device = support::load_device(options.device);
  const float force_max_N = setup.controller.limits.force_max_N;
  simulation::use_device(device.preset, setup);
  if (options.force_max->count() != 0) {
    core::limit_force(setup.controller, force_max_N);
  }
  if (setup.controller.device.kind != core::DeviceKind::kCartesian) {
    for (const CLI::Option* option : options.cartesian_only) {
      if (option->count() != 0) {
        refuse(fmt::format("{}: applies only to a cartesian device, which '{}' is not",
                           option->get_name(), device.name),
               "change the values in a device file, which --dump-device writes");
      }
    }
    return;
  }
  for (float& counts : setup.controller.device.counts_per_m) {
    counts = static_cast<float>(1.0 / options.encoder_step_m);
  }
  if (device.name == "cartesian") {
    setup.dynamics.reset();  // uses mass and friction of the options
  }
}

/// Origin of the model: that of --origin, else the one of simulation::middle_at_origin() for the
/// first body.
core::Vec3 place_model(const SimulateOptions& options, const SceneFile& scene,
                       core::DeviceKind kind) {
  if (!options.origin_m.empty()) {
    return {static_cast<float>(options.origin_m[0]), static_cast<float>(options.origin_m[1]),
            static_cast<float>(options.origin_m[2])};
  }
  return simulation::middle_at_origin(scene.files[0]->view().header(), scene.bodies[0].path.first(),
                                      kind);
}

[[noreturn]] void refuse_material(const std::string& file, const core::BlobView& view,
                                  const core::Configuration& controller) {
  const std::uint32_t index = core::find_unstable_material(view, controller);
  const core::BlobMaterial& material = view.material(index);
  refuse(fmt::format("{}: material {}: its stiffness of {:.6g} N/m is beyond the stability limit "
                     "of {:.6g} N/m with a hand at {:.6g} Hz",
                     file, index, material.stiffness_N_m,
                     core::material_limit(controller, material), controller.rate_hz),
         "build the blob with a softer or more damped --material, raise --rate, or simulate with "
         "--no-materials");
}

[[noreturn]] void refuse_slow_model(const std::string& file, const core::BlobView& view,
                                    const core::Configuration& controller,
                                    const SimulateOptions& options) {
  const std::string& board = options.board;
  const BoardCosts costs = costs_of_board(board, options.firmware);
  const double cycles = costs.cycles(view.header(), controller);
  refuse(
      fmt::format("{}: refused: a tick with it may take {:.0f} cycles on {}, {:.1f} us of {:.1f}",
                  file, cycles, board, 1e6 * cycles / costs.timing.clock_hz,
                  1e6 / static_cast<double>(controller.rate_hz)),
      fmt::format("use --rate {:.0f} or less, or build the model with --board {} --rate {:.0f}",
                  std::floor(costs.highest_rate(view.header(), controller)), board,
                  controller.rate_hz));
}

}  // namespace

[[noreturn]] void refuse(const std::string& what, const std::string& remedy) {
  throw support::UserError(fmt::format("{} ({})", what, remedy));
}

simulation::HandPath hand_path(const SimulateOptions& options, const SceneFile& scene) {
  if (!options.path.empty()) {
    return simulation::read_hand_path(options.path);
  }
  std::vector<simulation::Waypoint> waypoints =
      simulation::make_script(options.script, scene.files[0]->view(), options.seconds).waypoints();
  for (simulation::Waypoint& waypoint : waypoints) {
    waypoint.position_m = scene.bodies[0].path.first() * waypoint.position_m;
  }
  return simulation::HandPath(std::move(waypoints));
}

simulation::Setup make_setup(const SimulateOptions& options, const SceneFile& scene) {
  simulation::Setup setup = options.setup;
  core::Configuration& controller = setup.controller;
  controller.mode = options.mode == "paper" ? core::RenderMode::kPaper : core::RenderMode::kSurface;
  choose_device(options, setup);
  controller.model_origin_m = place_model(options, scene, controller.device.kind);
  setup.board.encoders.latency_ticks = static_cast<std::uint32_t>(options.latency_ticks);
  controller.supervision.supply_monitored = true;
  controller.delay_s = static_cast<float>(options.latency_ticks) / controller.rate_hz;
  core::limit_to_rate(controller);
  if (options.first_force && core::check(controller) == core::ConfigurationStatus::kOk) {
    controller = core::first_force(controller);
  }
  setup.homed = !options.unhomed;
  return setup;
}

std::vector<simulation::InjectedFault> injections(const SimulateOptions& options) {
  std::vector<simulation::InjectedFault> faults;
  for (const std::string& text : options.injections) {
    faults.push_back(simulation::parse_injection(text));
  }
  return faults;
}

void check_start(const std::string& file, const core::BlobView& view,
                 const simulation::Setup& setup, const hal::StartResult& start,
                 const SimulateOptions& options) {
  if (start.configuration == core::ConfigurationStatus::kUnstable) {
    const core::StabilityLimit limit = core::stability_limit(setup.controller);
    refuse(fmt::format("--stiffness: {:.6g} N/m is beyond the stability limit of {:.6g} N/m with a "
                       "hand at {:.6g} Hz",
                       setup.controller.contact.stiffness_N_m, limit.with_hand_N_m,
                       setup.controller.rate_hz),
           "lower --stiffness, or raise --rate or --damping");
  }
  if (start.image != hal::ImageStatus::kOk) {
    refuse(fmt::format("the board does not start: {}", describe(start)),
           start.image == hal::ImageStatus::kBadMemory ? "replace the board"
                                                       : "build the image again");
  }
  if (start.configuration != core::ConfigurationStatus::kOk) {
    refuse(fmt::format("configuration: {}", support::explain(core::refusal_of(setup.controller))),
           "give a value in that range");
  }
  if (start.blob != core::BlobStatus::kOk) {
    refuse(fmt::format("{}: refused: {}", file, describe(start)), "build it again from the scan");
  }
  if (start.model == core::ModelStatus::kTooStiff) {
    refuse_material(file, view, setup.controller);
  }
  if (start.model == core::ModelStatus::kTooSlow) {
    refuse_slow_model(file, view, setup.controller, options);
  }
  if (start.model != core::ModelStatus::kOk) {
    refuse(fmt::format("{}: {}", file, describe(start)),
           "build it with --profile surface, or use --mode paper");
  }
}

}  // namespace tactree::cli
