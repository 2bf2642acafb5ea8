#pragma once
// Arm MPS2 with the Cortex-M7 image AN500, in QEMU.

#include "plant_link/plant_link_board.hpp"

namespace tactree::firmware {
using Board = PlantLinkBoard;
}
