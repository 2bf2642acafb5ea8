#pragma once
// What `tactree simulate` does with its options.

#include <cstdint>
#include <optional>
#include <vector>

#include "run/simulate_options.hpp"
#include "tactree/emulation/instruction_counts.hpp"
#include "tactree/setup/scene_file.hpp"
#include "tactree/simulation/simulation.hpp"

namespace tactree::cli {

/// Effect of the injected faults.
struct Harm {
  double from_s = 0.0;               ///< time of the first injected fault
  std::optional<double> detected_s;  ///< time from from_s to the first latched fault
  double force_max_N = 0.0;          ///< after from_s
  double moved_m = 0.0;              ///< maximum distance from the path without faults
};

struct TickBound {
  std::uint64_t instructions = 0;
  bool work_is_reduced = false;  ///< see core::Controller::work_is_reduced()
};

/// Change of the state of a board that stands alone.
struct PanelEvent {
  double t_s = 0.0;
  core::State state = core::State::kBoot;
  bool homed = false;
};

struct Outcome {
  simulation::Summary summary;
  std::optional<Harm> harm;
  std::optional<emulation::InstructionCounts> instructions;  ///< of an emulated board
  std::optional<TickBound> bound;                            ///< if the image can be analysed
  std::vector<PanelEvent> panel;                             ///< of --panel
  std::vector<simulation::Sample> samples;                   ///< for --trace and --plot
  std::optional<double> interrupted_s;                       ///< time that Ctrl-C ended the run
};

/// Runs a session without user input at the full speed of the computer, and records it for
/// --record. Ctrl-C ends it after the present tick. Throws UserError.
[[nodiscard]] Outcome run(const SimulateOptions& options, const setup::SceneFile& scene);

/// Writes the files of --trace, --plot and --json. Throws UserError.
void write_results(const SimulateOptions& options, const setup::SceneFile& scene,
                   const Outcome& outcome);

void print_summary(const SimulateOptions& options, const setup::SceneFile& scene,
                   const Outcome& outcome);

/// --serve: a simulated board in real time, at a pseudo terminal or as a USB device. Returns when
/// the time is up or on a signal. Throws UserError.
void serve(const SimulateOptions& options, const setup::SceneFile& scene);

/// --replay: replays a recorded session on a new controller and prints the result. Returns true if
/// the outcome of every tick is bit-identical to the recorded outcome. Throws UserError if the
/// recording or a blob is not usable.
[[nodiscard]] bool replay_session(const SimulateOptions& options);

}  // namespace tactree::cli
