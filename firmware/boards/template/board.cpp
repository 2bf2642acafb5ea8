#include "board.hpp"

namespace tactree::firmware {

// CHANGE: clock frequency of the tick timer, Hz (on a Cortex-M, the core clock).
std::uint32_t timer_clock_hz() { return 25000000; }

// CHANGE: set up clocks and pins, and enable the clock of each peripheral in use. Variables are not
// initialised yet.
void prepare_board() {}

}  // namespace tactree::firmware
