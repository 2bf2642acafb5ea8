#pragma once
// Orderly termination by Ctrl-C of commands that run until they are stopped.

namespace tactree::cli {

/// Catches SIGINT and SIGTERM from now on; interrupted() reports them. Call it before starting any
/// thread.
void watch_interruption();
[[nodiscard]] bool interrupted();

}  // namespace tactree::cli
