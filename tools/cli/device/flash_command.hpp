#pragma once

#include <CLI/CLI.hpp>

namespace tactree::cli {

/// Adds the verb `flash`. Its errors are thrown as UserError or client::LinkError.
void add_flash_command(CLI::App& app, int& exit_code);

}  // namespace tactree::cli
