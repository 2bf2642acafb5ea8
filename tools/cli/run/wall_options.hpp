#pragma once
// Wall options of every simulated controller.

#include <CLI/CLI.hpp>

#include "tactree/core/configuration/configuration.hpp"

namespace tactree::cli {

/// Adds --rate, --stiffness and --damping. The configuration must outlive the command.
void add_wall_options(CLI::App& verb, core::Configuration& configuration);

}  // namespace tactree::cli
