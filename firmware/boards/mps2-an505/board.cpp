#include "board.hpp"

namespace tactree::firmware {

const char kBoardName[] = "mps2-an505";
const std::uint32_t kTimerClockHz = 20000000;

void prepare_board() {}  // the emulator starts with its clocks running

}  // namespace tactree::firmware
