// The main program of all boards: reads the configuration, opens the model and runs the control
// loop from the tick interrupt. If the configuration or the model is refused, the loop runs with
// the motors off and reports the cause.

#include "board.hpp"
#include "platform.hpp"
#include "runtime/identity.hpp"
#include "tactree/hal/loop.hpp"

namespace {

using tactree::firmware::Board;

Board board;
tactree::core::Controller controller;
tactree::hal::Loop<Board> loop(board, controller);

// If the self-test of the program or of RAM fails, no model is opened, so the motors stay off.
tactree::hal::StartResult start(const tactree::core::Configuration& configuration) {
  const tactree::hal::ImageStatus image = tactree::firmware::test_image();
  if (image == tactree::hal::ImageStatus::kOk) {
    controller.know_costs(tactree::firmware::tick_costs(), tactree::firmware::timer_clock_hz());
    return loop.start(configuration);
  }
  tactree::hal::StartResult refused;
  refused.image = image;
  return refused;
}

// A board with a port for applications serves them between the ticks and does not return.
template <class B>
void serve(B& on, const tactree::hal::StartResult& started,
           const tactree::core::Configuration& configuration) {
  if constexpr (requires { on.serve(controller, started, configuration); }) {
    on.serve(controller, started, configuration);
  }
}

}  // namespace

void tactree_tick() { loop.tick(); }

int main() {
  const tactree::core::Configuration configuration =
      board.connect(tactree::firmware::take_captured_fault());
  const tactree::hal::StartResult started = start(configuration);
  board.report(started);
  tactree::firmware::start_ticks(configuration.rate_hz);
  serve(board, started, configuration);
  tactree_idle();
}
