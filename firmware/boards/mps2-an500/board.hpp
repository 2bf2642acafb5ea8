#pragma once
// Arm MPS2 with the Cortex-M7 image AN500, in QEMU.

#include "plant_link/uart_board.hpp"
#include "uarts/cmsdk_uart.hpp"

namespace tactree::firmware {
using Board = UartBoard<CmsdkUart<0x40004000>>;
}  // namespace tactree::firmware
