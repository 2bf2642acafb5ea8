#pragma once

#include <CLI/CLI.hpp>

namespace tactree::cli {

/// Adds the verb `info`. Its errors are thrown as UserError.
void add_info_command(CLI::App& app, int& exit_code);

}  // namespace tactree::cli
