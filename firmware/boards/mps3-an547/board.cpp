#include "board.hpp"

namespace tactree::firmware {

const char kBoardName[] = "mps3-an547";
const std::uint32_t kTimerClockHz = 32000000;

void prepare_board() {}  // the emulator starts with its clocks running

}  // namespace tactree::firmware
