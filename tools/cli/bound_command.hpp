#pragma once

#include <CLI/CLI.hpp>

namespace tactree::cli {

/// `tactree bound`: how many instructions a tick of a board's image takes at most.
void add_bound_command(CLI::App& app, int& exit_code);

}  // namespace tactree::cli
