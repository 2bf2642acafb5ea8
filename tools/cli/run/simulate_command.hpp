#pragma once

#include <CLI/CLI.hpp>

namespace tactree::cli {

/// Adds the verb `simulate`. Its errors are thrown as UserError.
void add_simulate_command(CLI::App& app, int& exit_code);

}  // namespace tactree::cli
