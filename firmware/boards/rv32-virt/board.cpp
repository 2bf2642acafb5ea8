#include "board.hpp"

namespace tactree::firmware {

// The CLINT timer of QEMU's virt machine.
std::uint32_t timer_clock_hz() { return 10000000; }

void prepare_board() {}  // the emulator starts with its clocks running

}  // namespace tactree::firmware
