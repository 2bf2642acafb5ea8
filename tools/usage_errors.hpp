#pragma once
// What the programs say of a command line that they refuse.

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace tactree {

/// The names of the commands directly below a program or command.
[[nodiscard]] std::vector<std::string> command_names(const CLI::App& app);

/// Error message for a first argument that is not a command; empty if it is a command or an option.
[[nodiscard]] std::string unknown_command(const CLI::App& app, const std::string& word);

/// Error message with the option, its value and a remedy, instead of the one of CLI11. `app`: the
/// program, which has a name, and whose parse() has thrown `error`.
[[nodiscard]] std::string usage_error(const CLI::App& app, const CLI::Error& error);

}  // namespace tactree
