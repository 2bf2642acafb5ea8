#pragma once
// Orderly termination by Ctrl-C of verbs that run until stopped.

namespace tactree::cli {

/// Catches SIGINT and SIGTERM from now on; interrupted() reports them. Call before starting
/// threads.
void watch_interruption();
[[nodiscard]] bool interrupted();

}  // namespace tactree::cli
