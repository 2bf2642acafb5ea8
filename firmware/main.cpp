// The program of every board: gets a configuration, opens the model, and runs the control loop from
// the tick interrupt. When something is refused the loop runs all the same: it keeps the motors off
// and tells why.

#include "board.hpp"
#include "platform.hpp"
#include "tactree/hal/loop.hpp"

namespace {

using tactree::firmware::Board;

Board board;
tactree::core::Controller controller;
tactree::hal::Loop<Board> loop(board, controller);

}  // namespace

void tactree_tick() { loop.tick(); }

int main() {
  const tactree::core::Configuration configuration =
      board.connect(tactree::firmware::take_captured_fault());
  board.report(loop.start(configuration));
  tactree::firmware::start_ticks(configuration.rate_hz);
  tactree_idle();
}
