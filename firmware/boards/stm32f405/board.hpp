#pragma once
// The STM32F405 board on the hardware registers of the chip.

#include "stm32f405_board.hpp"

namespace tactree::firmware {

class Board : public Stm32f405Board<stm32f4::HardwareWord> {
 public:
  Board();
};

static_assert(hal::Board<Board>);

}  // namespace tactree::firmware
