#pragma once
// A board with an STM32H743 that stands alone: README.md in this folder.

#include "stm32f4/stand_alone_board.hpp"
#include "wiring.hpp"

namespace tactree::firmware {

class Board : public stm32f4::StandAloneBoard<stm32f4::HardwareWord> {
 public:
  Board();
  [[nodiscard]] core::Configuration connect(const hal::CapturedFault&) {
    return start(wiring::configuration());
  }
};

static_assert(hal::Board<Board>);

}  // namespace tactree::firmware
