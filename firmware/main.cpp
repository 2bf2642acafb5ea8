// The program of every board: gets a configuration, opens the model, and runs the control loop from
// the tick interrupt. When something is refused the loop runs all the same: it keeps the motors off
// and tells why.

#include "board.hpp"
#include "platform.hpp"
#include "runtime/identity.hpp"
#include "tactree/hal/loop.hpp"

namespace {

using tactree::firmware::Board;

Board board;
tactree::core::Controller controller;
tactree::hal::Loop<Board> loop(board, controller);

// A program with a wrong byte, or with a variable that does not hold, gets no model: it cannot give
// a force.
tactree::hal::StartResult start(const tactree::core::Configuration& configuration) {
  const tactree::hal::ImageStatus image = tactree::firmware::test_image();
  if (image == tactree::hal::ImageStatus::kOk) {
    controller.know_costs(tactree::firmware::tick_costs(), tactree::firmware::timer_clock_hz());
    return loop.start(configuration);
  }
  tactree::hal::StartResult unfit;
  unfit.image = image;
  return unfit;
}

// A board that an application can talk to listens between the ticks, for ever.
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
