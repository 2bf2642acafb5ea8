#pragma once
// The control loop of a Linux board, and the application's session between its ticks.

#include "controller_file.hpp"

namespace tactree::controller {

/// Runs until SIGTERM, SIGINT or SIGHUP. Prints a report at the end and on each SIGUSR1. Returns an
/// exit code. Throws before the first tick if something is refused.
[[nodiscard]] int serve(const ControllerFile& file);

}  // namespace tactree::controller
