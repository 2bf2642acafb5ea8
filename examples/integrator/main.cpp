// Firmware of the imaginary HC-3.

#include "hc3_board.hpp"
#include "tactree/hal/loop.hpp"

int main() {
  static hc3::Board board;
  static tactree::core::Controller controller;
  static tactree::hal::Loop<hc3::Board> loop(board, controller);

  tactree::core::Configuration configuration;
  use_device(tactree::core::presets::premium(), configuration);
  configuration.link.required = true;
  // After a refusal the loop runs as well: it keeps the motors off, and the status has the cause.
  (void)loop.start(configuration);
  while (true) {
    (void)loop.tick();
  }
}
