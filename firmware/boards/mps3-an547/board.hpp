#pragma once
// Arm MPS3 with the Cortex-M55 image AN547, in QEMU.

#include "plant_link/plant_link_board.hpp"

namespace tactree::firmware {
using Board = PlantLinkBoard;
}
