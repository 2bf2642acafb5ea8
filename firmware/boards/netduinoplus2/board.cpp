#include "board.hpp"

#include "stm32f4/program_in_ram.hpp"

namespace tactree::firmware {

std::uint32_t timer_clock_hz() { return 168000000; }

void prepare_board() {}  // the emulator starts with its clocks running

}  // namespace tactree::firmware
