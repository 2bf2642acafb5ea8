#include "board.hpp"

namespace tactree::firmware {

const char kBoardName[] = "netduinoplus2";
const std::uint32_t kTimerClockHz = 168000000;

void prepare_board() {}  // the emulator starts with its clocks running

}  // namespace tactree::firmware
