#include "board.hpp"

namespace tactree::firmware {

// CHANGE: the clock of the tick timer (on a Cortex-M that is the core's).
std::uint32_t timer_clock_hz() { return 25000000; }

// CHANGE: clocks, pins, and a clock for each part in use. No variable has its value yet.
void prepare_board() {}

}  // namespace tactree::firmware
