#include "board.hpp"

namespace tactree::firmware {

// CHANGE: clock of the tick timer, Hz (on a Cortex-M: the core clock).
std::uint32_t timer_clock_hz() { return 25000000; }

// CHANGE: clocks, pins, and a clock for each part in use. Variables are not initialised yet.
void prepare_board() {}

}  // namespace tactree::firmware
