#pragma once
// Wall options of every simulated controller.

#include <CLI/CLI.hpp>

#include "tactree/core/configuration/configuration.hpp"

namespace tactree::cli {

/// --rate, --stiffness, --damping. The configuration must outlive the verb.
void add_wall_options(CLI::App& verb, core::Configuration& configuration);

}  // namespace tactree::cli
