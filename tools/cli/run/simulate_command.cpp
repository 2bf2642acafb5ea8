#include <fmt/format.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>

#include "commands.hpp"
#include "device/device_defaults.hpp"
#include "exit_codes.hpp"
#include "run/simulate_options.hpp"
#include "run/simulate_run.hpp"
#include "run/simulate_setup.hpp"
#include "tactree/builder/length_text.hpp"
#include "tactree/setup/model_size.hpp"
#include "tactree/setup/scene_file.hpp"
#include "tactree/simulation/recording.hpp"
#include "tactree/simulation/repeated_path.hpp"
#include "tactree/support/device_file.hpp"
#include "tactree/support/output_file.hpp"
#include "tactree/viewer/trace_playback.hpp"

namespace tactree::cli {
namespace {

// Of a hand that repeats a motion. A softer one lags behind the friction of the device: at 300 N/m,
// the force differs by half of itself.
constexpr double kFollowing_N_m = 20000.0;
constexpr double kFollowing_Ns_m = 100.0;

/// "NAME: WARNING" for each body whose first pose, in the frame of the device, is beyond its reach.
std::string misplaced(const SimulateOptions& options, const setup::SceneFile& scene) {
  const core::DeviceModel device = support::load_device(options.device).preset.model;
  std::string all;
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    const auto warning = setup::misplaced_warning(scene.files[i]->view(), options.device, device,
                                                  scene.bodies[i].path.first());
    if (warning) {
      all += fmt::format("{}{}: {}", all.empty() ? "" : "; ", scene.names[i], *warning);
    }
  }
  return all;
}

/// Empty for a model that --origin or a scene without a pose file has placed: the user may want the
/// device to reach only a part of it.
std::string reach_warning(const SimulateOptions& options, const setup::SceneFile& scene) {
  if (scene.in_device_frame) {
    return misplaced(options, scene);
  }
  if (is_scene(options) || !options.origin_m.empty()) {
    return "";
  }
  const auto warning = setup::oversize_warning(scene.files[0]->view(), options.device,
                                               support::load_device(options.device).preset.model);
  return warning ? fmt::format("{}: {}", options.blob, *warning) : "";
}

std::string remedy_for_no_contact(const SimulateOptions& options, const core::BlobHeader& model,
                                  bool oversize) {
  if (oversize) {
    return "make the model smaller or move it, as the warning says";
  }
  if (options.panel) {
    return "home and arm the board by its button, e.g. --press 0.5s..1.7s --press 3s..4.2s, with "
           "--seconds to touch afterwards, or accept the run with --allow-no-contact";
  }
  if (options.mode == "paper") {
    return fmt::format(
        "the method of the paper finds a contact only within {} of a point, and a pressing hand "
        "passes between and behind the points: use --mode surface, or accept the run with "
        "--allow-no-contact",
        builder::length_text(0.5 * static_cast<double>(model.aabb_edge_m), 2));
  }
  return "choose a --script, --path or --origin with which the hand meets its surface, or accept "
         "the run with --allow-no-contact";
}

/// True for a recording of a board and for a trace, by the columns of the probe. Not for a pipe,
/// which can be read once only.
bool is_recording(const std::filesystem::path& file) {
  if (file.extension() == ".npz") {
    return true;
  }
  std::error_code ignored;
  std::string header;
  if (std::filesystem::is_regular_file(file, ignored)) {
    std::ifstream in(file);
    std::getline(in, header);
  }
  return header.find("probe_x_m") != std::string::npos;
}

/// A file of simulate --record has no positions of the hand.
void refuse_recorded_inputs(const std::string& file) {
  std::error_code ignored;
  std::string magic(sizeof simulation::kRecordingMagic, '\0');
  if (std::filesystem::is_regular_file(file, ignored) &&
      std::ifstream(file, std::ios::binary)
          .read(magic.data(), sizeof simulation::kRecordingMagic) &&
      std::memcmp(magic.data(), simulation::kRecordingMagic, magic.size()) == 0) {
    refuse(fmt::format("{}: has the inputs of a controller, but no path of a hand", file),
           "replay it with --replay; --trace and tactree record write what --path repeats");
  }
}

simulation::HandPath path_of_recording(const std::string& file) {
  try {
    return simulation::repeated_path(viewer::read_trace(file));
  } catch (const std::invalid_argument& error) {
    refuse(fmt::format("{}: {}", file, error.what()),
           "arm the board while it is recorded: record --arm");
  }
}

/// What the user does not state: the run is as long as the recording, and the hand so stiff that
/// the device follows within about a count of its encoders.
void repeat_recording(SimulateOptions& options) {
  options.repeated = path_of_recording(options.path);
  if (options.seconds_given->count() == 0) {
    options.seconds = options.repeated->waypoints().back().t_s +
                      1.0 / static_cast<double>(options.setup.controller.rate_hz);
  }
  if (options.stiffness_given->count() == 0) {
    options.setup.plant.hand.stiffness_N_m = kFollowing_N_m;
  }
  if (options.damping_given->count() == 0) {
    options.setup.plant.hand.damping_Ns_m = kFollowing_Ns_m;
  }
}

void simulate(SimulateOptions& options, int& exit_code) {
  if (options.dump_device) {
    fmt::print("{}", support::device_json(support::load_device(options.device)));
    return;
  }
  if (options.blobs.empty() && options.scene.empty()) {
    throw CLI::RequiredError("BLOB");
  }
  std::vector<std::filesystem::path> inputs(options.blobs.begin(), options.blobs.end());
  inputs.insert(inputs.end(), {options.scene, options.pose, options.path, options.replay,
                               options.device, options.key});
  const std::vector<std::filesystem::path> outputs{options.record, options.trace, options.plot,
                                                   options.json};
  support::check_outputs(outputs, inputs);
  if (!options.replay.empty()) {
    exit_code = replay_session(options) ? kExitOk : kExitFailed;
    return;
  }
  if (!options.record.empty() && !options.board.empty() && options.board != "host") {
    refuse(fmt::format("--record: not possible with {}, which assembles its inputs in the emulator",
                       options.board),
           "omit --board; the ticks on the host are bit-identical");
  }
  check_panel(options);
  refuse_recorded_inputs(options.path);
  const setup::SceneFile scene = setup::read_scene(options.scene, options.blobs, options.pose);
  support::check_outputs(outputs, scene.read);
  options.blob = scene.names[0];
  if (is_recording(options.path)) {
    repeat_recording(options);
  }
  note_defaults(options.device, support::load_device(options.device));
  if (options.serve) {
    serve(options, scene);
    return;
  }
  const std::string beyond = reach_warning(options, scene);
  if (!beyond.empty()) {
    fmt::print(stderr, "tactree: warning: {}\n", beyond);
  }
  const Outcome outcome = run(options, scene);
  write_results(options, scene, outcome);
  print_summary(options, scene, outcome);
  if (outcome.interrupted_s) {
    fmt::print(stderr,
               "tactree: warning: interrupted after {:.3f} s of {:g} s; the results are those of "
               "the ticks until then\n",
               *outcome.interrupted_s, options.seconds);
    exit_code = kExitFailed;
    return;
  }
  exit_code = outcome.summary.faults.empty() ? kExitOk : kExitFailed;
  if (exit_code == kExitOk && outcome.summary.contact_ticks == 0 && !options.allow_no_contact) {
    refuse(fmt::format("{}: the probe never touched the model", options.blob),
           remedy_for_no_contact(options, scene.files[0]->view().header(), !beyond.empty()));
  }
}

}  // namespace

void add_simulate_command(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<SimulateOptions>();
  CLI::App* verb = app.add_subcommand(
      "simulate", "Runs the controller of the firmware against a simulated device and hand");
  add_simulate_options(*verb, *options);
  verb->callback([options, &exit_code] { simulate(*options, exit_code); });
}

}  // namespace tactree::cli
