#pragma once
// Results of a run of `tactree simulate`: files, and the summary on the terminal.

#include "run/scene_file.hpp"
#include "run/simulate_options.hpp"
#include "run/simulate_run.hpp"

namespace tactree::cli {

/// Writes the files of --trace, --plot and --json. Throws UserError.
void write_results(const SimulateOptions& options, const SceneFile& scene, const Outcome& outcome);

void print_summary(const SimulateOptions& options, const SceneFile& scene, const Outcome& outcome);

}  // namespace tactree::cli
