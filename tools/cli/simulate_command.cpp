#include "simulate_command.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "blob_file.hpp"
#include "board_costs.hpp"
#include "command.hpp"
#include "device_file.hpp"
#include "json_text.hpp"
#include "model_signature.hpp"
#include "output_file.hpp"
#include "scene_file.hpp"
#include "serve_session.hpp"
#include "tactree/bound/bound.hpp"
#include "tactree/bound/bound_error.hpp"
#include "tactree/emulation/emulated_target.hpp"
#include "tactree/hal/linux/function_fs_controller.hpp"
#include "tactree/hal/linux/usbip_controller.hpp"
#include "tactree/host/serial_port.hpp"
#include "tactree/serve/served_target.hpp"
#include "tactree/serve/usb_target.hpp"
#include "tactree/simulation/hand_script.hpp"
#include "tactree/simulation/injection.hpp"
#include "tactree/simulation/placement.hpp"
#include "tactree/simulation/simulation.hpp"
#include "tactree/simulation/trace.hpp"
#include "usb_port.hpp"
#include "wall_options.hpp"

namespace tactree::cli {
namespace {

constexpr double kMaxTicks = 1e8;
// A trace or plot keeps every sample in memory.
constexpr double kMaxTracedTicks = 5e6;

struct SimulateOptions {
  std::vector<std::string> blobs;
  std::string scene;
  std::string blob;  // of the first body
  std::string board = "host";
  std::string firmware;
  std::string device = "premium";
  bool dump_device = false;
  std::vector<double> origin_m;  // of the model, device frame; empty: its middle at the origin
  std::string script = "rub";
  std::string path;
  std::string mode = "surface";
  std::string trace;
  std::string plot;
  bool compare = false;
  std::string json;
  bool serve = false;
  std::string key;  // of who signs models for the served board
  bool on_usb = false;
  std::optional<std::string> usb_port;  // of this computer, as a device; empty: the only one
  std::uint32_t serial = 1;
  CLI::Option* seconds_given = nullptr;
  std::vector<std::string> injections;
  double seconds = 10.0;
  double latency_ticks = 0.0;
  double encoder_step_m = 30e-6;
  std::vector<CLI::Option*> cartesian_only;
  CLI::Option* force_max = nullptr;
  simulation::Setup setup;
};

/// Where the controller or the simulation refuses what the user asked for.
[[noreturn]] void refuse(const std::string& what, const std::string& remedy) {
  throw CommandError(fmt::format("{} ({})", what, remedy));
}

/// A script touches the first body where that begins.
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

/// The device, for controller and mechanics alike; what the options say of it goes before.
void choose_device(const SimulateOptions& options, simulation::Setup& setup) {
  const Device device = load_device(options.device);
  const float force_max_N = setup.controller.force_max_N;
  simulation::use_device(device.figures, setup);
  if (options.force_max->count() != 0) {
    setup.controller.force_max_N = force_max_N;
  }
  if (setup.controller.device.kind != core::DeviceKind::kCartesian) {
    for (const CLI::Option* option : options.cartesian_only) {
      if (option->count() != 0) {
        refuse(fmt::format("{}: the device '{}' is not cartesian", option->get_name(), device.name),
               "change its file: --dump-device writes one");
      }
    }
    return;
  }
  for (float& counts : setup.controller.device.counts_per_m) {
    counts = static_cast<float>(1.0 / options.encoder_step_m);
  }
  if (device.name == "cartesian") {
    setup.dynamics.reset();  // the options' mass and friction
  }
}

/// What --origin says, or else the first body's middle at the device's origin.
core::Vec3 place_model(const SimulateOptions& options, const SceneFile& scene,
                       core::DeviceKind kind) {
  if (!options.origin_m.empty()) {
    return {static_cast<float>(options.origin_m[0]), static_cast<float>(options.origin_m[1]),
            static_cast<float>(options.origin_m[2])};
  }
  return simulation::middle_at_origin(scene.files[0]->view().header(), scene.bodies[0].path.first(),
                                      kind);
}

simulation::Setup make_setup(const SimulateOptions& options, const SceneFile& scene) {
  simulation::Setup setup = options.setup;
  core::Configuration& controller = setup.controller;
  controller.mode = options.mode == "paper" ? core::RenderMode::kPaper : core::RenderMode::kSurface;
  choose_device(options, setup);
  controller.model_origin_m = place_model(options, scene, controller.device.kind);
  setup.board.encoders.latency_ticks = static_cast<std::uint32_t>(options.latency_ticks);
  controller.supply_monitored = true;
  controller.delay_s = static_cast<float>(options.latency_ticks) / controller.rate_hz;
  controller.velocity_cutoff_hz =
      std::min(controller.velocity_cutoff_hz, 0.5F * controller.rate_hz);
  return setup;
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
      fmt::format("--rate: up to {:.0f}; or build it with --board {} --rate {:.0f}",
                  std::floor(costs.highest_rate(view.header(), controller)), board,
                  controller.rate_hz));
}

void check_start(const std::string& file, const core::BlobView& view,
                 const simulation::Setup& setup, const hal::StartResult& start,
                 const SimulateOptions& options) {
  if (start.configuration == core::ConfigurationStatus::kUnstable) {
    const core::StabilityLimit limit = core::stability_limit(setup.controller);
    refuse(
        fmt::format("--stiffness: {:.6g} N/m is beyond the stability limit of {:.6g} N/m with a "
                    "hand at {:.6g} Hz",
                    setup.controller.stiffness_N_m, limit.with_hand_N_m, setup.controller.rate_hz),
        "lower --stiffness, or raise --rate or --damping");
  }
  if (start.image == hal::ImageStatus::kBadMemory) {
    refuse("the board's memory: a bit of it does not hold what is written", "replace the board");
  }
  if (start.image != hal::ImageStatus::kOk) {
    refuse("the board's image: a byte of it is not as it was built", "build the image again");
  }
  if (start.configuration != core::ConfigurationStatus::kOk) {
    refuse(fmt::format("configuration: {}", core::describe(start.configuration)),
           "give a value in that range");
  }
  if (start.blob != core::BlobStatus::kOk) {
    refuse(fmt::format("{}: refused: {}", file, core::describe(start.blob)),
           "build it again from the scan");
  }
  if (start.model == core::ModelStatus::kTooStiff) {
    refuse_material(file, view, setup.controller);
  }
  if (start.model == core::ModelStatus::kTooSlow) {
    refuse_slow_model(file, view, setup.controller, options);
  }
  if (start.model != core::ModelStatus::kOk) {
    refuse(fmt::format("{}: {}", file, core::describe(start.model)),
           "build it with --profile surface, or use --mode paper");
  }
}

// Functions the summary names, of those the ticks' instructions are in.
constexpr std::size_t kReportedFunctions = 10;

/// What faults on purpose did.
struct Harm {
  double from_s = 0.0;               // the first was injected
  std::optional<double> detected_s;  // after that: the first fault was latched
  double force_max_N = 0.0;          // from then on
  double moved_m = 0.0;              // furthest off the way of the same session without them
};

struct Outcome {
  simulation::Summary summary;
  std::optional<Harm> harm;
  std::optional<emulation::InstructionCounts> instructions;  // of an emulated board
  std::optional<std::uint64_t> bound;  // of a tick's instructions, where its image can be analysed
  std::vector<simulation::Sample> samples;
};

std::vector<std::string> board_names() {
  std::vector<std::string> names{"host"};
  for (const emulation::BoardDescription& board : emulation::boards()) {
    names.emplace_back(board.name);
  }
  return names;
}

std::unique_ptr<emulation::EmulatedTarget> boot_board(const emulation::BoardDescription& board,
                                                      const SimulateOptions& options,
                                                      const simulation::Setup& setup,
                                                      const BlobFile& blob) {
  emulation::EmulationOptions emulation;
  emulation.image = emulation::find_image(board, options.firmware);
  emulation.uncounted_ticks = simulation::Simulation::arming_ticks(setup);
  return std::make_unique<emulation::EmulatedTarget>(board, blob.bytes(), emulation);
}

bool is_scene(const SimulateOptions& options) {
  return !options.scene.empty() || options.blobs.size() > 1;
}

/// Where the controller runs, and what of it is there.
struct ChosenTarget {
  std::unique_ptr<simulation::Target> target;
  const simulation::SceneTarget* scene = nullptr;
  const emulation::EmulatedTarget* emulated = nullptr;
};

ChosenTarget host_target(const SimulateOptions& options, const simulation::Setup& setup,
                         const SceneFile& scene) {
  if (!is_scene(options)) {
    return {std::make_unique<simulation::HostTarget>()};
  }
  auto target = std::make_unique<simulation::SceneTarget>(
      scene.bodies, simulation::Simulation::arming_ticks(setup));
  const simulation::SceneTarget* const bodies = target.get();
  return {std::move(target), bodies};
}

ChosenTarget board_target(const emulation::BoardDescription& board, const SimulateOptions& options,
                          const simulation::Setup& setup, const SceneFile& scene) {
  if (scene.bodies.size() > 1) {
    refuse(fmt::format("--board {}: a board has one blob in its flash, the scene has {} bodies",
                       board.name, scene.bodies.size()),
           "use --board host, or leave one body");
  }
  auto target = boot_board(board, options, setup, *scene.files[0]);
  const emulation::EmulatedTarget* const emulated = target.get();
  if (!is_scene(options)) {
    return {std::move(target), nullptr, emulated};
  }
  return {std::make_unique<simulation::LinkedBodyTarget>(
              std::move(target), scene.bodies[0], simulation::Simulation::arming_ticks(setup)),
          nullptr, emulated};
}

ChosenTarget choose_target(const SimulateOptions& options, const simulation::Setup& setup,
                           const SceneFile& scene) {
  const emulation::BoardDescription* board = emulation::find_board(options.board);
  return board == nullptr ? host_target(options, setup, scene)
                          : board_target(*board, options, setup, scene);
}

std::vector<simulation::InjectedFault> injections(const SimulateOptions& options) {
  std::vector<simulation::InjectedFault> faults;
  for (const std::string& text : options.injections) {
    faults.push_back(simulation::parse_injection(text));
  }
  return faults;
}

/// The same session, in step, with nothing broken; and what is different in the one that is.
class Comparison {
 public:
  Comparison(const SimulateOptions& options, const SceneFile& scene, const simulation::Setup& setup,
             const std::vector<simulation::InjectedFault>& faults)
      : sound_(scene.files[0]->bytes(), setup, hand_path(options, scene),
               std::make_unique<simulation::SceneTarget>(
                   scene.bodies, simulation::Simulation::arming_ticks(setup))) {
    (void)sound_.arm();
    harm_.from_s = faults.front().from_s;
    for (const simulation::InjectedFault& fault : faults) {
      harm_.from_s = std::min(harm_.from_s, fault.from_s);
    }
  }

  void add(const simulation::Sample& sample) {
    const simulation::Sample sound = sound_.step();
    if (sample.t_s < harm_.from_s) {
      return;
    }
    if (sample.status.faults != 0U && !harm_.detected_s) {
      harm_.detected_s = sample.t_s - harm_.from_s;
    }
    const double force = static_cast<double>(core::length(sample.status.force));
    harm_.force_max_N = std::max(harm_.force_max_N, force);
    harm_.moved_m = std::max(harm_.moved_m, (sample.tip_m - sound.tip_m).norm());
  }

  [[nodiscard]] const Harm& harm() const { return harm_; }

 private:
  simulation::Simulation sound_;
  Harm harm_;
};

/// Nothing for a board whose code cannot be analysed.
std::optional<std::uint64_t> bound_of_tick(const SimulateOptions& options, const SceneFile& scene,
                                           const core::Configuration& controller) {
  bound::BoundOptions analysis =
      analysis_of(*emulation::find_board(options.board), options.firmware);
  analysis.parameters = bound::parameters_of(scene.files[0]->view().header(), controller.mode, 1,
                                             controller.device.kind);
  analysis.pace = core::pace_of(controller.rate_hz);
  try {
    return bound::worst_case(analysis).instructions;
  } catch (const bound::BoundError&) {
    return std::nullopt;
  }
}

Outcome run(const SimulateOptions& options, const SceneFile& scene) {
  const BlobFile& blob = *scene.files[0];
  const simulation::Setup setup = make_setup(options, scene);
  const double count = std::round(options.seconds * static_cast<double>(setup.controller.rate_hz));
  const bool keep = !options.trace.empty() || !options.plot.empty();
  const double most = keep ? kMaxTracedTicks : kMaxTicks;
  if (!(count >= 1.0 && count <= most)) {
    refuse(fmt::format("--seconds: {:.6g} ticks are outside 1 .. {:.0f}", count, most),
           keep ? "shorten it, or leave --trace and --plot out" : "choose another --seconds");
  }
  ChosenTarget chosen = choose_target(options, setup, scene);
  simulation::Simulation sim(blob.bytes(), setup, hand_path(options, scene),
                             std::move(chosen.target));
  const std::size_t refused = chosen.scene == nullptr ? 0 : chosen.scene->refused_body();
  check_start(scene.names[refused], scene.files[refused]->view(), setup, sim.start_result(),
              options);
  if (!sim.arm()) {
    refuse(fmt::format("the controller did not become active, it is in state {}",
                       core::name_of(sim.state())),
           "begin the path outside the object");
  }
  const std::vector<simulation::InjectedFault> faults = injections(options);
  sim.inject(simulation::Injector(faults));
  std::optional<Comparison> comparison;
  if (!faults.empty()) {
    comparison.emplace(options, scene, setup, faults);
  }
  Outcome outcome;
  simulation::Recorder recorder;
  for (double i = 0.0; i < count; i += 1.0) {
    const simulation::Sample sample = sim.step();
    recorder.add(sample);
    if (comparison) {
      comparison->add(sample);
    }
    if (keep) {
      outcome.samples.push_back(sample);
    }
  }
  sim.finish();
  outcome.summary = recorder.summary();
  if (comparison) {
    outcome.harm = comparison->harm();
  }
  if (chosen.emulated != nullptr) {
    outcome.instructions = chosen.emulated->instruction_counts();
    outcome.bound = bound_of_tick(options, scene, setup.controller);
  }
  return outcome;
}

void write_trace(const std::string& file, const std::vector<simulation::Sample>& samples) {
  std::string csv = simulation::trace_heading();
  for (const simulation::Sample& sample : samples) {
    simulation::append_trace(csv, sample);
  }
  write_file(file, csv);
}

nlohmann::json instructions_json(const Outcome& outcome) {
  const std::optional<emulation::InstructionCounts>& counts = outcome.instructions;
  if (!counts) {
    return {{"max", nullptr}, {"mean", nullptr}, {"bound", nullptr}};
  }
  nlohmann::json functions = nlohmann::json::array();
  for (const emulation::FunctionCount& f : counts->functions) {
    const double mean = static_cast<double>(f.total) / static_cast<double>(counts->ticks);
    functions.push_back({{"name", f.name}, {"max", f.max}, {"mean", mean}});
  }
  const auto bound = outcome.bound ? nlohmann::json(*outcome.bound) : nlohmann::json(nullptr);
  return {{"max", counts->max},     {"mean", counts->mean()},       {"bound", bound},
          {"start", counts->start}, {"checksum", counts->checksum}, {"functions", functions}};
}

nlohmann::json to_json(const std::vector<std::string>& injections, const Harm& harm) {
  return {{"faults", injections},
          {"from_s", harm.from_s},
          {"detected_s", harm.detected_s ? nlohmann::json(*harm.detected_s) : nlohmann::json()},
          {"force_max_N", harm.force_max_N},
          {"moved_m", harm.moved_m}};
}

nlohmann::json to_json(const SceneFile& scene, const simulation::Summary& s) {
  nlohmann::json bodies = nlohmann::json::array();
  for (std::size_t i = 0; i < scene.names.size(); ++i) {
    bodies.push_back({{"blob", scene.names[i]},
                      {"contact_ticks", s.bodies[i].contact_ticks},
                      {"force_max_N", s.bodies[i].force_max_N},
                      {"torque_max_Nm", s.bodies[i].torque_max_Nm}});
  }
  return bodies;
}

nlohmann::json to_json(const SimulateOptions& options, const SceneFile& scene,
                       const Outcome& outcome) {
  const simulation::Summary& s = outcome.summary;
  nlohmann::json faults = nlohmann::json::array();
  for (const simulation::FaultEvent& event : s.faults) {
    faults.push_back({{"code", static_cast<int>(event.fault)},
                      {"name", core::name_of(event.fault)},
                      {"tick", event.tick}});
  }
  return {
      {"board", options.board},
      {"device", options.device},
      {"mode", options.mode},
      {"rate_hz", options.setup.controller.rate_hz},
      {"ticks", s.ticks},
      {"contact_ticks", s.contact_ticks},
      {"overruns", s.overruns},
      {"force_max_N", s.force_max_N},
      {"force_step_max_N", s.force_step_max_N},
      {"penetration_max_m", s.penetration_max_m},
      {"trace_crc32", s.trace_crc32},
      {"faults", faults},
      {"bodies", to_json(scene, s)},
      {"crowded_ticks", s.crowded_ticks},
      {"injected", outcome.harm ? to_json(options.injections, *outcome.harm) : nlohmann::json()},
      {"instructions", instructions_json(outcome)}};
}

void print_instructions(const emulation::InstructionCounts& counts,
                        std::optional<std::uint64_t> bound) {
  fmt::print("instructions       {:.0f} per tick on average, {} at most{}, {} before the first\n",
             counts.mean(), counts.max, bound ? fmt::format(" (bound {})", *bound) : "",
             counts.start);
  for (std::size_t i = 0; i < std::min(kReportedFunctions, counts.functions.size()); ++i) {
    const emulation::FunctionCount& f = counts.functions[i];
    fmt::print("  {:8.0f} {:8}  {}\n",
               static_cast<double>(f.total) / static_cast<double>(counts.ticks), f.max, f.name);
  }
}

void print_bodies(const SceneFile& scene, const simulation::Summary& s) {
  for (std::size_t i = 0; i < scene.names.size(); ++i) {
    const simulation::BodySummary& body = s.bodies[i];
    fmt::print("body {:<14}{}: in contact {}, largest force {:.4f} N, torque {:.4g} Nm\n", i,
               scene.names[i], body.contact_ticks, body.force_max_N, body.torque_max_Nm);
  }
  if (s.crowded_ticks > 0) {
    fmt::print("crowded            {} ticks: more than {} bodies within reach, some not felt\n",
               s.crowded_ticks, core::kMaxReachableBodies);
  }
}

void print_harm(const SimulateOptions& options, const Harm& harm) {
  fmt::print("injected           {}\n", fmt::join(options.injections, ", "));
  if (harm.detected_s) {
    fmt::print("detected           after {:.1f} ms\n", 1e3 * *harm.detected_s);
  } else {
    fmt::print("detected           no fault was latched\n");
  }
  fmt::print("largest force      {:.4f} N after it\n", harm.force_max_N);
  fmt::print("moved the tip      up to {:.2f} mm off the way it takes without\n",
             1e3 * harm.moved_m);
}

void print_summary(const SimulateOptions& options, const SceneFile& scene, const Outcome& outcome) {
  const simulation::Summary& s = outcome.summary;
  fmt::print("board {}, device {}, mode {}, {:.6g} Hz\n", options.board, options.device,
             options.mode, options.setup.controller.rate_hz);
  fmt::print("ticks              {}\n", s.ticks);
  fmt::print("in contact         {} ({:.1f} %)\n", s.contact_ticks,
             100.0 * static_cast<double>(s.contact_ticks) / static_cast<double>(s.ticks));
  fmt::print("largest force      {:.4f} N\n", s.force_max_N);
  fmt::print("largest step       {:.4f} N per tick\n", s.force_step_max_N);
  fmt::print("deepest            {:.4f} mm\n", 1e3 * s.penetration_max_m);
  fmt::print("overruns           {}\n", s.overruns);
  fmt::print("trace checksum     {:08x}\n", s.trace_crc32);
  if (is_scene(options)) {
    print_bodies(scene, s);
  }
  for (const simulation::FaultEvent& event : s.faults) {
    fmt::print("fault {:2} {} at tick {}\n", static_cast<int>(event.fault),
               core::name_of(event.fault), event.tick);
  }
  if (outcome.harm) {
    print_harm(options, *outcome.harm);
  }
  if (outcome.instructions) {
    print_instructions(*outcome.instructions, outcome.bound);
  }
}

/// Of an emulated board: how long its ticks were.
simulation::Histogram histogram(const Outcome& outcome) {
  simulation::Histogram h;
  if (outcome.instructions) {
    h.label = "instructions per tick";
    h.bar_width = static_cast<double>(emulation::kBucketInstructions);
    for (const emulation::InstructionBucket& bucket : outcome.instructions->buckets) {
      h.bars.push_back({static_cast<double>(bucket.fewest), static_cast<double>(bucket.ticks)});
    }
  }
  return h;
}

void write_plot(const SimulateOptions& options, const SceneFile& scene, const Outcome& outcome) {
  const double rate_hz = static_cast<double>(options.setup.controller.rate_hz);
  if (!options.compare) {
    const std::string title = fmt::format("{}: {}, {} mode, {:.6g} Hz", options.blob,
                                          options.device, options.mode, rate_hz);
    write_file(options.plot, simulation::plot_svg(outcome.samples, title, histogram(outcome)));
    return;
  }
  SimulateOptions other = options;
  other.mode = options.mode == "paper" ? "surface" : "paper";
  const Outcome beside = run(other, scene);
  const bool paper_first = options.mode == "paper";
  const std::string title =
      fmt::format("{}: {}, both modes, {:.6g} Hz", options.blob, options.device, rate_hz);
  write_file(options.plot,
             simulation::plot_modes_svg(paper_first ? beside.samples : outcome.samples,
                                        paper_first ? outcome.samples : beside.samples, title));
}

serve::ServeOptions serve_options(const SimulateOptions& options) {
  serve::ServeOptions serving;
  serving.serial = options.serial;
  if (!options.key.empty()) {
    serving.key = read_public_key(options.key);
  }
  return serving;
}

std::unique_ptr<simulation::Target> served_target(const SimulateOptions& options,
                                                  const SceneFile& scene,
                                                  host::Transport& terminal) {
  const BlobFile& blob = *scene.files[0];
  const serve::ServeOptions serving = serve_options(options);
  const emulation::BoardDescription* const board = emulation::find_board(options.board);
  if (board == nullptr) {
    return std::make_unique<serve::ServedTarget>(terminal, blob.bytes(), serving);
  }
  if (serving.key) {
    refuse(fmt::format("--require-key: the image of {} has no key", board->name),
           "use --board host");
  }
  emulation::EmulationOptions emulation;
  emulation.image = emulation::find_image(*board, options.firmware);
  emulation.count_instructions = false;
  emulation.served = &terminal;
  return std::make_unique<emulation::EmulatedTarget>(*board, blob.bytes(), emulation);
}

void serve_target(const SimulateOptions& options, const SceneFile& scene,
                  std::unique_ptr<simulation::Target> target, ServeSchedule schedule) {
  const simulation::Setup setup = make_setup(options, scene);
  simulation::Simulation sim(scene.files[0]->bytes(), setup, hand_path(options, scene),
                             std::move(target));
  check_start(scene.names[0], scene.files[0]->view(), setup, sim.start_result(), options);
  sim.inject(simulation::Injector(injections(options)));
  schedule.rate_hz = static_cast<double>(setup.controller.rate_hz);
  schedule.path_s = options.seconds;
  schedule.seconds_max = options.seconds_given->count() != 0 ? options.seconds : 0.0;
  serve_session(sim, schedule);
}

template <class Controller>
void serve_on_usb(const SimulateOptions& options, const SceneFile& scene,
                  const core::usb::Identity& identity, Controller& controller) {
  auto target = std::make_unique<serve::UsbTarget<Controller>>(
      controller, identity, scene.files[0]->bytes(), serve_options(options));
  auto& served = *target;
  watch_cable_signal();
  controller.plug_in();
  tell_cable(true);
  ServeSchedule schedule;
  schedule.wait = [&](auto due) { serve_until(due, served, controller); };
  serve_target(options, scene, std::move(target), schedule);
  controller.unplug();
}

void serve(const SimulateOptions& options, const SceneFile& scene) {
  if ((options.on_usb || options.usb_port) && options.board != "host") {
    refuse(fmt::format("--board {}: an emulated board has no USB port", options.board),
           "use --board host, or leave --usb out");
  }
  const emulation::BoardDescription* const board = emulation::find_board(options.board);
  if (board != nullptr && !board->serves) {
    refuse(fmt::format("--board {}: its image is too small for an application to talk to",
                       options.board),
           "choose another board, or leave --serve out");
  }
  core::usb::Identity identity;
  identity.name = "Simulated controller";
  identity.serial = {0, 0, options.serial};
  if (options.on_usb) {
    hal::linux_usb::UsbIpController controller;
    serve_on_usb(options, scene, identity, controller);
  } else if (options.usb_port) {
    hal::linux_usb::FunctionFsController controller(identity, *options.usb_port);
    serve_on_usb(options, scene, identity, controller);
  } else {
    host::PseudoTerminal terminal;
    auto target = served_target(options, scene, terminal);
    fmt::print("serving at {}\n", terminal.name());
    std::fflush(stdout);
    serve_target(options, scene, std::move(target), {});
  }
}

void simulate(SimulateOptions& options, int& exit_code) {
  if (options.dump_device) {
    fmt::print("{}", device_json(load_device(options.device)));
    return;
  }
  if (options.blobs.empty() && options.scene.empty()) {
    throw CLI::RequiredError("BLOB");
  }
  const SceneFile scene = read_scene(options.scene, options.blobs);
  options.blob = scene.names[0];
  if (options.serve) {
    serve(options, scene);
    return;
  }
  const Outcome outcome = run(options, scene);
  if (!options.trace.empty()) {
    write_trace(options.trace, outcome.samples);
  }
  if (!options.plot.empty()) {
    write_plot(options, scene, outcome);
  }
  if (!options.json.empty()) {
    write_file(options.json, json_text(to_json(options, scene, outcome)));
  }
  print_summary(options, scene, outcome);
  exit_code = outcome.summary.faults.empty() ? kExitOk : kExitFailed;
}

void add_controller_options(CLI::App& verb, SimulateOptions& options) {
  core::Configuration& c = options.setup.controller;
  add_wall_options(verb, c);
  verb.add_option("--passivity", c.passivity_Ns_m,
                  "most damping that the passivity controller may add, Ns/m; 0: off")
      ->check(CLI::Range(0.0, 100.0))
      ->capture_default_str();
  verb.add_option("--static-friction", c.static_friction, "coefficient")
      ->check(CLI::Range(0.0, 2.0))
      ->capture_default_str();
  verb.add_option("--dynamic-friction", c.dynamic_friction, "coefficient, at most the static one")
      ->check(CLI::Range(0.0, 2.0))
      ->capture_default_str();
  verb.add_flag("!--no-materials", c.use_materials,
                "feel the options above everywhere, whatever materials the blob has");
  options.force_max =
      verb.add_option("--force-max", c.force_max_N, "largest force, N (default: the device's)")
          ->check(CLI::Range(0.01, 1000.0));
}

std::string injection_help() {
  std::string text =
      "break something: PART:KIND[=VALUE]@FROM[..TO], seconds after arming; may be given again";
  for (const simulation::InjectionHelp& kind : simulation::injection_kinds()) {
    text += fmt::format("\n  {:<22} {}", kind.name, kind.about);
  }
  return text;
}

void add_injection_option(CLI::App& verb, SimulateOptions& options) {
  verb.add_option("--inject", options.injections, injection_help())
      ->check(CLI::Validator(
          [](const std::string& text) -> std::string {
            try {
              (void)simulation::parse_injection(text);
              return {};
            } catch (const std::invalid_argument& error) {
              return error.what();
            }
          },
          "FAULT"))
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
}

void add_plant_options(CLI::App& verb, SimulateOptions& options) {
  plant::PlantParameters& plant = options.setup.plant;
  options.cartesian_only = {
      verb.add_option("--device-mass", plant.device.mass_kg, "cartesian: apparent mass, kg")
          ->check(CLI::Range(1e-4, 100.0))
          ->capture_default_str(),
      verb.add_option("--device-friction", plant.device.coulomb_N,
                      "cartesian: dry friction of each axis, N")
          ->check(CLI::Range(0.0, 100.0))
          ->capture_default_str(),
      verb.add_option("--encoder-step", options.encoder_step_m, "cartesian: travel of one count, m")
          ->check(CLI::Range(1e-8, 1e-2))
          ->capture_default_str()};
  verb.add_option("--latency-ticks", options.latency_ticks, "age of an encoder reading, ticks")
      ->check(CLI::Range(0, static_cast<int>(hal::sim::kMaxLatencyTicks)))
      ->capture_default_str();
  verb.add_option("--hand-stiffness", plant.hand.stiffness_N_m, "spring of the hand, N/m")
      ->check(CLI::Range(0.0, 1e5))
      ->capture_default_str();
  verb.add_option("--hand-damping", plant.hand.damping_Ns_m, "damper of the hand, Ns/m")
      ->check(CLI::Range(0.0, 1e3))
      ->capture_default_str();
  verb.add_option("--hand-mass", plant.hand.mass_kg, "mass that moves with the device, kg")
      ->check(CLI::Range(0.0, 100.0))
      ->capture_default_str();
}

void add_device_options(CLI::App& verb, SimulateOptions& options) {
  std::string names;
  for (const std::string& name : device_names()) {
    names += (names.empty() ? "" : ", ") + name;
  }
  verb.add_option("--device", options.device, names + ", or a JSON file that describes another")
      ->capture_default_str();
  verb.add_flag("--dump-device", options.dump_device,
                "print the device as such a file, to begin one's own with, and do nothing else");
  verb.add_option("--origin", options.origin_m,
                  "where the model's origin is in the device's frame (x to the user, y right, z "
                  "up), m; default: the model's middle at the device's origin, "
                  "with a device of one or two axes the middle of its top")
      ->expected(3)
      ->check(CLI::Range(-10.0, 10.0));
}

void add_output_options(CLI::App& verb, SimulateOptions& options) {
  verb.add_option("--trace", options.trace, "write every tick to this CSV file");
  CLI::Option* plot =
      verb.add_option("--plot", options.plot, "draw force and penetration into this SVG file");
  verb.add_flag("--compare", options.compare,
                "draw the force of both modes into the plot, along the same path")
      ->needs(plot);
  verb.add_option("--json", options.json, "write the summary to this file");
}

}  // namespace

void add_simulate_command(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<SimulateOptions>();
  CLI::App* verb = app.add_subcommand(
      "simulate", "Runs the controller of the firmware against a simulated device and hand");
  verb->add_option("BLOB", options->blobs, "the blob to touch, or several");
  verb->add_option(
          "--scene", options->scene,
          "JSON file that says where each body is, of which of the blobs, and how it moves")
      ->check(CLI::ExistingFile);
  verb->add_option("--board", options->board, "where the controller runs")
      ->check(CLI::IsMember(board_names()))
      ->capture_default_str();
  verb->add_option("--firmware", options->firmware,
                   "folder with the images of the emulated boards (default: $TACTREE_FIRMWARE, the "
                   "installation, or the build tree)");
  add_device_options(*verb, *options);
  verb->add_option("--mode", options->mode, "how contact is rendered")
      ->check(CLI::IsMember({"surface", "paper"}))
      ->capture_default_str();
  options->seconds_given = verb->add_option("--seconds", options->seconds, "length of the run, s")
                               ->check(CLI::PositiveNumber)
                               ->capture_default_str();
  CLI::Option* serve =
      verb->add_flag("--serve", options->serve,
                     "run in real time and let programs talk to the board, at a port that is "
                     "printed; without --seconds until it is interrupted");
  verb->add_option("--require-key", options->key,
                   "with --serve: public key (tactree keygen) whose owner must have signed a model")
      ->needs(serve)
      ->check(CLI::ExistingFile);
  CLI::Option* usb = verb->add_flag(
      "--usb", options->on_usb,
      "with --serve: be a USB device of this computer (needs root and the module vhci-hcd); "
      "SIGUSR1 pulls the cable, and plugs it in again");
  usb->needs(serve);
  verb->add_option("--usb-gadget", options->usb_port,
                   "with --serve: be a USB device at this computer's device port, one of "
                   "/sys/class/udc (default: the only one); needs root and the module usb_f_fs")
      ->expected(0, 1)
      ->default_str("")
      ->needs(serve)
      ->excludes(usb);
  verb->add_option("--serial", options->serial, "with --serve: last digits of the serial number")
      ->needs(serve);
  CLI::Option* script = verb->add_option("--script", options->script, "what the hand does")
                            ->check(CLI::IsMember(simulation::script_names()))
                            ->capture_default_str();
  verb->add_option("--path", options->path, "CSV file with the hand's way: t_s,x,y,z (s, m)")
      ->excludes(script);
  add_controller_options(*verb, *options);
  add_plant_options(*verb, *options);
  add_injection_option(*verb, *options);
  add_output_options(*verb, *options);
  verb->callback([options, &exit_code] { simulate(*options, exit_code); });
}

}  // namespace tactree::cli
