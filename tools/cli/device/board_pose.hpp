#pragma once
// The option --pose of the commands that arm a board.

#include <CLI/CLI.hpp>
#include <string>

#include "tactree/client/board.hpp"
#include "tactree/simulation/placement.hpp"

namespace tactree::cli {

CLI::Option* add_pose_option(CLI::App& verb, std::string& file);

/// Reads a pose file for a board, which keeps the size of its model. Throws UserError.
[[nodiscard]] simulation::Placement read_board_pose(const std::string& file);

/// Sends the pose of the file to the board; nothing if `file` is empty. Throws UserError,
/// LinkError.
void send_pose(client::Board& board, const std::string& file);

}  // namespace tactree::cli
