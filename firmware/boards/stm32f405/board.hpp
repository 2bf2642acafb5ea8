#pragma once
// The STM32F405 board on the hardware registers of the chip.

#include "stm32f405_board.hpp"

namespace tactree::firmware {

class Board : public Stm32f405Board<stm32f4::HardwareWord> {
 public:
  Board();

  // Compiled for size in board.cpp, because neither is part of a tick.
  [[nodiscard]] core::Configuration connect(const hal::CapturedFault& last_fault);
  void serve(core::Controller& controller, const hal::StartResult& started,
             const core::Configuration& configuration);
};

static_assert(hal::Board<Board>);

}  // namespace tactree::firmware
