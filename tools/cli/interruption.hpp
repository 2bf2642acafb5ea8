#pragma once
// Ctrl-C for verbs that go on until somebody ends them: they put things in order first.

namespace tactree::cli {

/// From now on SIGINT and SIGTERM do not end the program; interrupted() tells of them.
void watch_interruption();
bool interrupted();

}  // namespace tactree::cli
