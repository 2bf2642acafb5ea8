#pragma once
// `tactree build INPUT... -o OUT.blob`

#include <CLI/CLI.hpp>

namespace tactree::cli {

/// Adds the verb `build`. Its errors are thrown as UserError, ReadError or BuildError.
void add_build_command(CLI::App& app, int& exit_code);

}  // namespace tactree::cli
