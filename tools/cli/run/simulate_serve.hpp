#pragma once
// `tactree simulate --serve`: a simulated board in real time, at a pseudo terminal or as a USB
// device.

#include "run/scene_file.hpp"
#include "run/simulate_options.hpp"

namespace tactree::cli {

/// Returns when the time is up or on a signal. Throws UserError.
void serve(const SimulateOptions& options, const SceneFile& scene);

}  // namespace tactree::cli
