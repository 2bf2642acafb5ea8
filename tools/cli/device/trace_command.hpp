#pragma once

#include <CLI/CLI.hpp>

namespace tactree::cli {

/// Adds the verb `trace`. Its errors are thrown as UserError or client::LinkError.
void add_trace_command(CLI::App& app, int& exit_code);

}  // namespace tactree::cli
