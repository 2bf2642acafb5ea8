#pragma once
// Run of `tactree simulate`: a session without user input at the full speed of the computer.

#include <cstdint>
#include <optional>
#include <vector>

#include "run/scene_file.hpp"
#include "run/simulate_options.hpp"
#include "tactree/emulation/instruction_counts.hpp"
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

struct Outcome {
  simulation::Summary summary;
  std::optional<Harm> harm;
  std::optional<emulation::InstructionCounts> instructions;  ///< of an emulated board
  std::optional<TickBound> bound;                            ///< if the image can be analysed
  std::vector<simulation::Sample> samples;                   ///< for --trace and --plot
};

/// Runs the session and records it for --record. Throws UserError.
[[nodiscard]] Outcome run(const SimulateOptions& options, const SceneFile& scene);

}  // namespace tactree::cli
