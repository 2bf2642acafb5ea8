#pragma once

#include <CLI/CLI.hpp>

namespace tactree::cli {

/// Adds the verb `bound`: instructions and cycles of a tick, at most. Its errors are UserError
/// and wcet::BoundError.
void add_bound_command(CLI::App& app, int& exit_code);

}  // namespace tactree::cli
