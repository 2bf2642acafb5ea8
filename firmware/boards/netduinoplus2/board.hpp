#pragma once
// Netduino Plus 2 in QEMU: an STM32F405 (Cortex-M4 with FPU, 168 MHz). The host simulates the plant
// over the plant link.

#include "plant_link/plant_link_board.hpp"

namespace tactree::firmware {
using Board = PlantLinkBoard;
}
