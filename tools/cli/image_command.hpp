#pragma once

#include <CLI/CLI.hpp>

namespace tactree::cli {

/// `tactree image`: firmware and blob in one file for a programmer or boot loader.
void add_image_command(CLI::App& app, int& exit_code);

}  // namespace tactree::cli
