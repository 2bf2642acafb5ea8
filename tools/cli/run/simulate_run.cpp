#include "run/simulate_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "image/board_costs.hpp"
#include "run/simulate_setup.hpp"
#include "tactree/emulation/emulated_target.hpp"
#include "tactree/setup/session.hpp"
#include "tactree/simulation/recording.hpp"
#include "tactree/support/output_file.hpp"
#include "tactree/wcet/bound.hpp"
#include "tactree/wcet/bound_error.hpp"

namespace tactree::cli {
namespace {

constexpr double kMaxTicks = 1e8;
// Limit for a trace, plot or recording, which keeps every tick in memory.
constexpr double kMaxTracedTicks = 5e6;

std::unique_ptr<emulation::EmulatedTarget> boot_board(const emulation::BoardDescription& board,
                                                      const SimulateOptions& options,
                                                      const simulation::Setup& setup,
                                                      const support::BlobFile& blob) {
  emulation::EmulationOptions emulation;
  emulation.image = emulation::find_image(board, options.firmware);
  emulation.uncounted_ticks = simulation::Simulation::arming_ticks(setup);
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
  auto target = std::make_unique<simulation::SceneTarget>(
      scene.bodies, simulation::Simulation::arming_ticks(setup));
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
  return {std::make_unique<simulation::LinkedBodyTarget>(
              std::move(target), scene.bodies[0], simulation::Simulation::arming_ticks(setup)),
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

/// Runs the ticks after arming, and those of a fault-free session if faults are injected.
Outcome run_ticks(simulation::Simulation& sim, std::uint64_t ticks, const SimulateOptions& options,
                  const setup::SceneFile& scene) {
  const std::vector<simulation::InjectedFault> faults = injections(options);
  sim.inject(simulation::Injector(faults));
  std::optional<Comparison> comparison;
  if (!faults.empty()) {
    comparison.emplace(options, scene, make_setup(options, scene), faults);
  }
  Outcome outcome;
  simulation::Recorder recorder;
  for (std::uint64_t i = 0; i < ticks; ++i) {
    const simulation::Sample sample = sim.step();
    recorder.add(sample);
    if (comparison) {
      comparison->add(sample);
    }
    if (keeps_samples(options)) {
      outcome.samples.push_back(sample);
    }
  }
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
  simulation::SessionWriter writer;
  setup.board.recorder = options.record.empty() ? nullptr : &writer;
  ChosenTarget chosen = choose_target(options, setup, scene);
  simulation::Simulation sim(scene.files[0]->bytes(), setup, hand_path(options, scene),
                             std::move(chosen.target));
  const std::size_t refused = chosen.scene == nullptr ? 0 : chosen.scene->refused_body();
  check_start(scene.names[refused], scene.files[refused]->view(), setup, sim.start_result(),
              options);
  if (!sim.arm()) {
    setup::refuse_inactive(options.device, setup, sim);
  }
  writer.begin_trace();
  Outcome outcome = run_ticks(sim, ticks, options, scene);
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
