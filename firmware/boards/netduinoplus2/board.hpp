#pragma once
// Netduino Plus 2: an STM32F405, Cortex-M4 with FPU at 168 MHz, in QEMU; its plant over the link.

#include "plant_link/plant_link_board.hpp"

namespace tactree::firmware {
using Board = PlantLinkBoard;
}
