#pragma once
// `tactree simulate --replay`: replays a recorded session on a new controller.

#include "run/simulate_options.hpp"

namespace tactree::cli {

/// Prints the result. Returns true if the outcome of every tick is bit-identical to the recorded
/// outcome. Throws UserError if the recording or a blob is not usable.
[[nodiscard]] bool replay_session(const SimulateOptions& options);

}  // namespace tactree::cli
