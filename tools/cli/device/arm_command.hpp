#pragma once

#include <CLI/CLI.hpp>

namespace tactree::cli {

/// Adds the verb `arm`. Its errors are thrown as UserError or client::LinkError.
void add_arm_command(CLI::App& app, int& exit_code);

}  // namespace tactree::cli
