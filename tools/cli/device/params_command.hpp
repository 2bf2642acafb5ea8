#pragma once

#include <CLI/CLI.hpp>

namespace tactree::cli {

/// Adds the verb `params`. Its errors are thrown as UserError or client::LinkError.
void add_params_command(CLI::App& app, int& exit_code);

}  // namespace tactree::cli
