#pragma once

#include <CLI/CLI.hpp>

namespace tactree::cli {

/// Adds the verb `keygen`. Its errors are thrown as UserError or client::LinkError.
void add_keygen_command(CLI::App& app, int& exit_code);

}  // namespace tactree::cli
