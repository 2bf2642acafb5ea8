#pragma once
// RISC-V, rv32imafc: QEMU's virt machine with the core sifive-e34.

#include "plant_link/plant_link_board.hpp"

namespace tactree::firmware {
using Board = PlantLinkBoard;
}
