#include "board.hpp"

namespace tactree::firmware {

const char kBoardName[] = "mps2-an386";
const std::uint32_t kTimerClockHz = 25000000;

void prepare_board() {}  // the emulator starts with its clocks running

}  // namespace tactree::firmware
