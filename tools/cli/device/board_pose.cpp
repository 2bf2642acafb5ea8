#include "device/board_pose.hpp"

#include <fmt/format.h>

#include "option_checks.hpp"
#include "tactree/setup/pose_file.hpp"
#include "tactree/simulation/body_path.hpp"
#include "tactree/support/user_error.hpp"

namespace tactree::cli {

CLI::Option* add_pose_option(CLI::App& verb, std::string& file) {
  return verb
      .add_option("--pose", file,
                  "first send the pose of this file, as the page of view saves it: where the model "
                  "is in the frame of the device. It stays until another one, another model or a "
                  "reset")
      ->check(existing_file());
}

simulation::Placement read_board_pose(const std::string& file) {
  const simulation::Placement placement = setup::read_pose_file(file);
  if (placement.scale != 1.0) {
    support::refuse(
        file + ".scale",
        fmt::format("{:.6g}: a board cannot change the size of its model", placement.scale),
        "build the model with --pose, which needs no other pose, or with --scale, and "
        "remove \"scale\" from the file");
  }
  return placement;
}

void send_pose(client::Board& board, const std::string& file) {
  if (file.empty()) {
    return;
  }
  const simulation::Placement placement = read_board_pose(file);
  const simulation::BodyPath rest(simulation::in_scene(placement.pose, board.model_origin_m()));
  board.place_body(0, rest.at(0.0).pose);
}

}  // namespace tactree::cli
