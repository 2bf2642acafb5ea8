#pragma once

#include <CLI/CLI.hpp>

namespace tactree::cli {

/// Adds the verb `sign`. Its errors are thrown as UserError or client::LinkError.
void add_sign_command(CLI::App& app, int& exit_code);

}  // namespace tactree::cli
