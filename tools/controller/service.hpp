#pragma once
// The control loop of a Linux board, and the application's session between its ticks.

#include <vector>

#include "controller_file.hpp"

namespace tactree::controller {

/// Runs until SIGTERM or SIGINT; prints a report then, and at each SIGUSR1. Returns an exit code.
/// Throws where something is refused, before the first tick.
[[nodiscard]] int serve(const ControllerFile& file);

}  // namespace tactree::controller
