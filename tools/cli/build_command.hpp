#pragma once
// `tactree build INPUT... -o OUT.blob`: from scans to the blob that is flashed.

#include <CLI/CLI.hpp>

namespace tactree::cli {

void add_build_command(CLI::App& app, int& exit_code);

}  // namespace tactree::cli
