#include "board.hpp"

namespace tactree::firmware {

const char kBoardName[] = "rv32-virt";
const std::uint32_t kTimerClockHz = 10000000;

void prepare_board() {}  // the emulator starts with its clocks running

}  // namespace tactree::firmware
