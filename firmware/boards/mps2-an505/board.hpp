#pragma once
// Arm MPS2+ with the Cortex-M33 image AN505, in QEMU; all in the secure world.

#include "plant_link/plant_link_board.hpp"

namespace tactree::firmware {
using Board = PlantLinkBoard;
}
