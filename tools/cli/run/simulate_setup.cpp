#include "run/simulate_setup.hpp"

#include <fmt/format.h>

#include <cmath>

#include "image/board_costs.hpp"
#include "tactree/support/device_file.hpp"
#include "tactree/support/user_error.hpp"

namespace tactree::cli {
namespace {

/// Options that describe a cartesian device have no effect on another one.
void check_cartesian_options(const SimulateOptions& options) {
  const support::Device device = support::load_device(options.device);
  if (device.preset.model.kind == core::DeviceKind::kCartesian) {
    return;
  }
  for (const CLI::Option* option : options.cartesian_only) {
    if (option->count() != 0) {
      refuse(fmt::format("{}: applies only to a cartesian device, which '{}' is not",
                         option->get_name(), device.name),
             "change the values in a device file, which --dump-device writes");
    }
  }
}

setup::FirstBody first_body(const setup::SceneFile& scene) {
  return {scene.files[0]->view(), scene.bodies[0].path.first(), scene.in_device_frame};
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

/// A fault without an effect would make a safety test pass.
void require_effect(const std::string& text, const simulation::InjectedFault& fault,
                    const SimulateOptions& options, const support::Device& device) {
  const std::uint32_t axes = core::axes_of(device.preset.model.kind);
  if (fault.axes.size() == 1 && fault.axes[0] >= axes) {
    refuse(fmt::format("--inject {}: '{}' has {} {}", text, device.name, axes,
                       axes == 1 ? "axis" : "axes"),
           "name one of its axes, or omit the number for all");
  }
  if (!options.serve && fault.from_s >= options.seconds) {
    refuse(fmt::format("--inject {}: begins after the end of the run, which takes {:.6g} s", text,
                       options.seconds),
           "raise --seconds");
  }
}

}  // namespace

[[noreturn]] void refuse(const std::string& what, const std::string& remedy) {
  throw support::UserError(fmt::format("{} ({})", what, remedy));
}

simulation::HandPath hand_path(const SimulateOptions& options, const setup::SceneFile& scene) {
  return options.repeated ? *options.repeated : setup::hand_path(options, first_body(scene));
}

simulation::Setup make_setup(const SimulateOptions& options, const setup::SceneFile& scene) {
  check_cartesian_options(options);
  simulation::Setup setup = setup::make_setup(options, first_body(scene));
  setup.homed = !options.unhomed && !options.panel;
  if (options.panel) {
    setup.controller.link.required = false;
    setup.controller.link.may_command = false;
  }
  return setup;
}

std::vector<simulation::InjectedFault> injections(const SimulateOptions& options) {
  std::vector<simulation::InjectedFault> faults;
  const support::Device device = support::load_device(options.device);
  for (const std::string& text : options.injections) {
    const simulation::InjectedFault& fault = faults.emplace_back(simulation::parse_injection(text));
    require_effect(text, fault, options, device);
  }
  return faults;
}

std::vector<simulation::Press> presses(const SimulateOptions& options) {
  std::vector<simulation::Press> all;
  for (const std::string& text : options.presses) {
    all.push_back(simulation::parse_press(text));
  }
  return all;
}

void check_panel(const SimulateOptions& options) {
  if (!options.panel) {
    return;
  }
  if (is_scene(options)) {
    refuse("--panel: no application is connected that places or moves bodies",
           "give one BLOB, without --scene and --pose; build --pose places the model itself");
  }
  for (const simulation::InjectedFault& fault : injections(options)) {
    if (fault.kind == simulation::InjectedKind::kLinkDead ||
        fault.kind == simulation::InjectedKind::kLinkArm) {
      refuse("--panel: no application is connected whose link may fail", "omit --inject link:...");
    }
  }
}

void check_start(const std::string& file, const core::BlobView& view,
                 const simulation::Setup& setup, const hal::StartResult& start,
                 const SimulateOptions& options) {
  if (start.model == core::ModelStatus::kTooSlow) {
    refuse_slow_model(file, view, setup.controller, options);
  }
  setup::check_start(file, view, setup, start);
}

}  // namespace tactree::cli
