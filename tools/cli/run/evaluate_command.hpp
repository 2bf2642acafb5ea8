#pragma once

#include <CLI/CLI.hpp>

namespace tactree::cli {

/// Adds the verb `evaluate`. Its errors are thrown as UserError.
void add_evaluate_command(CLI::App& app, int& exit_code);

}  // namespace tactree::cli
