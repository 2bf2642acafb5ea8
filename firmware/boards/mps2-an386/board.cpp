#include "board.hpp"

namespace tactree::firmware {

// SYSCLK of QEMU's model of the AN386.
std::uint32_t timer_clock_hz() { return 25000000; }

void prepare_board() {}  // the emulator starts with its clocks running

}  // namespace tactree::firmware
