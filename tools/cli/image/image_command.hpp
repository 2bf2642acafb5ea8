#pragma once

#include <CLI/CLI.hpp>

namespace tactree::cli {

/// Adds the verb `image`: firmware and blob in one file. Its errors are thrown as UserError.
void add_image_command(CLI::App& app, int& exit_code);

}  // namespace tactree::cli
