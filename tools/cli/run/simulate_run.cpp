#include "run/simulate_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "image/board_costs.hpp"
#include "interruption.hpp"
#include "run/simulate_setup.hpp"
#include "tactree/builder/progress.hpp"
#include "tactree/emulation/emulated_target.hpp"
#include "tactree/setup/session.hpp"
#include "tactree/simulation/recording.hpp"
#include "tactree/simulation/user.hpp"
#include "tactree/support/output_file.hpp"
#include "tactree/wcet/bound.hpp"
#include "tactree/wcet/bound_error.hpp"

namespace tactree::cli {
namespace {

constexpr double kMaxTicks = 1e8;
constexpr std::uint64_t kTicksPerLook = 1000;  // at the progress
// Limit for a trace, plot or recording, which keeps every tick in memory.
constexpr double kMaxTracedTicks = 5e6;

/// Ticks before time 0. A board that stands alone is not armed before.
std::uint64_t ticks_before(const SimulateOptions& options, const simulation::Setup& setup) {
  return options.panel ? 0U : simulation::Simulation::arming_ticks(setup);
}

/// How the board is operated: armed before time 0, or by a user with its panel.
class Operation {
 public:
  Operation(const SimulateOptions& options, const simulation::Setup& setup) {
    if (options.panel) {
      user_.emplace(static_cast<double>(setup.controller.rate_hz), options.seconds,
                    presses(options));
    }
  }

  /// Returns false if the board is not active although it was armed.
  [[nodiscard]] bool begin(simulation::Simulation& sim) const { return user_ || sim.arm(); }
  simulation::Sample step(simulation::Simulation& sim) {
    return user_ ? user_->step(sim) : sim.step();
  }

 private:
  std::optional<simulation::User> user_;
};

std::unique_ptr<emulation::EmulatedTarget> boot_board(const emulation::BoardDescription& board,
                                                      const SimulateOptions& options,
                                                      const simulation::Setup& setup,
                                                      const support::BlobFile& blob) {
  emulation::EmulationOptions emulation;
  emulation.image = emulation::find_image(board, options.firmware);
  emulation.uncounted_ticks = ticks_before(options, setup);
  return std::make_unique<emulation::EmulatedTarget>(board, blob.bytes(), emulation);
}

/// Target of the controller, and access to its concrete type.
struct ChosenTarget {
  std::unique_ptr<simulation::Target> target;
  const simulation::SceneTarget* scene = nullptr;
  const emulation::EmulatedTarget* emulated = nullptr;
};

ChosenTarget host_target(const SimulateOptions& options, const simulation::Setup& setup,
                         const setup::SceneFile& scene) {
  if (!is_scene(options)) {
    return {std::make_unique<simulation::HostTarget>()};
  }
  auto target =
      std::make_unique<simulation::SceneTarget>(scene.bodies, ticks_before(options, setup));
  const simulation::SceneTarget* const bodies = target.get();
  return {std::move(target), bodies};
}

ChosenTarget board_target(const emulation::BoardDescription& board, const SimulateOptions& options,
                          const simulation::Setup& setup, const setup::SceneFile& scene) {
  if (scene.bodies.size() > 1) {
    refuse(fmt::format("--board {}: a board has one blob in its flash, the scene has {} bodies",
                       board.name, scene.bodies.size()),
           "use --board host, or a scene of one body");
  }
  auto target = boot_board(board, options, setup, *scene.files[0]);
  const emulation::EmulatedTarget* const emulated = target.get();
  if (!is_scene(options)) {
    return {std::move(target), nullptr, emulated};
  }
  return {std::make_unique<simulation::LinkedBodyTarget>(std::move(target), scene.bodies[0],
                                                         ticks_before(options, setup)),
          nullptr, emulated};
}

ChosenTarget choose_target(const SimulateOptions& options, const simulation::Setup& setup,
                           const setup::SceneFile& scene) {
  const emulation::BoardDescription* board = emulation::find_board(options.board);
  return board == nullptr ? host_target(options, setup, scene)
                          : board_target(*board, options, setup, scene);
}

/// Runs the same session without faults in lockstep and measures the differences.
class Comparison {
 public:
  Comparison(const SimulateOptions& options, const setup::SceneFile& scene,
             const simulation::Setup& setup, const std::vector<simulation::InjectedFault>& faults)
      : sound_(
            scene.files[0]->bytes(), setup, hand_path(options, scene),
            std::make_unique<simulation::SceneTarget>(scene.bodies, ticks_before(options, setup))),
        operation_(options, setup) {
    (void)operation_.begin(sound_);
    harm_.from_s = faults.front().from_s;
    for (const simulation::InjectedFault& fault : faults) {
      harm_.from_s = std::min(harm_.from_s, fault.from_s);
    }
  }

  void add(const simulation::Sample& sample) {
    const simulation::Sample sound = operation_.step(sound_);
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
  Operation operation_;
  Harm harm_;
};

/// Work tier of the controller in the image, which is later than that of the rate if its costs
/// require it.
std::uint32_t tier_of_board(const SimulateOptions& options, const wcet::BoundOptions& analysis,
                            const setup::SceneFile& scene, const core::Configuration& controller) {
  const bool has_costs = wcet::embedded(analysis.image).known == core::kTickCostsKnown;
  return has_costs ? costs_of_board(options.board, options.firmware)
                         .work_tier(scene.files[0]->view().header(), controller)
                   : core::work_tier_of(controller.rate_hz);
}

/// Empty for a board whose code cannot be analysed.
std::optional<TickBound> bound_of_tick(const SimulateOptions& options,
                                       const setup::SceneFile& scene,
                                       const core::Configuration& controller) {
  wcet::BoundOptions analysis =
      analysis_of(*emulation::find_board(options.board), options.firmware);
  analysis.parameters = wcet::parameters_of(scene.files[0]->view().header(), controller.mode, 1,
                                            controller.device.kind);
  try {
    analysis.work_tier = tier_of_board(options, analysis, scene, controller);
    return TickBound{wcet::worst_case(analysis).instructions,
                     analysis.work_tier > core::work_tier_of(controller.rate_hz)};
  } catch (const wcet::BoundError&) {
    return std::nullopt;
  }
}

bool keeps_samples(const SimulateOptions& options) {
  return !options.trace.empty() || !options.plot.empty();
}

std::uint64_t ticks_of(const SimulateOptions& options, const simulation::Setup& setup) {
  const double count = std::round(options.seconds * static_cast<double>(setup.controller.rate_hz));
  const bool keep = keeps_samples(options) || !options.record.empty();
  const double most = keep ? kMaxTracedTicks : kMaxTicks;
  if (!(count >= 1.0 && count <= most)) {
    refuse(fmt::format("--seconds: {:.6g} ticks are outside 1 .. {:.0f}", count, most),
           keep ? "reduce it, or omit --trace, --plot and --record" : "choose another --seconds");
  }
  return static_cast<std::uint64_t>(count);
}

void note_event(const simulation::Sample& sample, std::vector<PanelEvent>& events) {
  const bool homed = (sample.status.limits & core::limit_bit(core::Limit::kNotHomed)) == 0U;
  if (events.empty() || events.back().state != sample.status.state ||
      events.back().homed != homed) {
    events.push_back({sample.t_s, sample.status.state, homed});
  }
}

/// Runs the ticks from time 0 on, and those of a fault-free session if faults are injected. Ends
/// early on Ctrl-C.
Outcome run_ticks(simulation::Simulation& sim, Operation& operation, std::uint64_t ticks,
                  const SimulateOptions& options, const setup::SceneFile& scene) {
  const std::vector<simulation::InjectedFault> faults = injections(options);
  sim.inject(simulation::Injector(faults));
  std::optional<Comparison> comparison;
  if (!faults.empty()) {
    comparison.emplace(options, scene, make_setup(options, scene), faults);
  }
  Outcome outcome;
  simulation::Recorder recorder;
  const auto progress = builder::make_progress(builder::ProgressStyle::kAuto, stderr);
  progress->begin("simulating");
  for (std::uint64_t i = 0; i < ticks; ++i) {
    if (interrupted()) {
      outcome.interrupted_s =
          static_cast<double>(i) / static_cast<double>(options.setup.controller.rate_hz);
      break;
    }
    if (i % kTicksPerLook == 0) {
      progress->advance(static_cast<double>(i) / static_cast<double>(ticks));
    }
    const simulation::Sample sample = operation.step(sim);
    recorder.add(sample);
    if (comparison) {
      comparison->add(sample);
    }
    if (options.panel) {
      note_event(sample, outcome.panel);
    }
    if (keeps_samples(options)) {
      outcome.samples.push_back(sample);
    }
  }
  progress->end();
  outcome.summary = recorder.summary();
  if (comparison) {
    outcome.harm = comparison->harm();
  }
  return outcome;
}

}  // namespace

Outcome run(const SimulateOptions& options, const setup::SceneFile& scene) {
  simulation::Setup setup = make_setup(options, scene);
  const std::uint64_t ticks = ticks_of(options, setup);
  watch_interruption();
  simulation::SessionWriter writer;
  setup.board.recorder = options.record.empty() ? nullptr : &writer;
  ChosenTarget chosen = choose_target(options, setup, scene);
  simulation::Simulation sim(scene.files[0]->bytes(), setup, hand_path(options, scene),
                             std::move(chosen.target));
  const std::size_t refused = chosen.scene == nullptr ? 0 : chosen.scene->refused_body();
  check_start(scene.names[refused], scene.files[refused]->view(), setup, sim.start_result(),
              options);
  Operation operation(options, setup);
  if (!operation.begin(sim)) {
    setup::refuse_inactive(options.device, setup, sim);
  }
  writer.begin_trace();
  Outcome outcome = run_ticks(sim, operation, ticks, options, scene);
  sim.finish();
  if (!options.record.empty()) {
    support::write_file(options.record, writer.finish());
  }
  if (chosen.emulated != nullptr) {
    outcome.instructions = chosen.emulated->instruction_counts();
    outcome.bound = bound_of_tick(options, scene, setup.controller);
  }
  return outcome;
}

}  // namespace tactree::cli
