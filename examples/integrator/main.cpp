// Firmware of the imaginary HC-3.

#include "hc3_board.hpp"
#include "tactree/hal/loop.hpp"

int main() {
  static hc3::Board board;
  static tactree::core::Controller controller;
  static tactree::hal::Loop<hc3::Board> loop(board, controller);

  tactree::core::Configuration configuration;
  use_device(tactree::core::presets::premium(), configuration);
  configuration.link_required = true;
  // What is refused here the status tells; the loop runs all the same and keeps the motors off.
  (void)loop.start(configuration);
  while (true) {
    (void)loop.tick();
  }
}
