#pragma once
// Arm MPS3 with the Cortex-M55 image AN547, in QEMU.

#include "plant_link/uart_board.hpp"
#include "uarts/cmsdk_uart.hpp"

namespace tactree::firmware {
using Board = UartBoard<CmsdkUart<0x59303000>>;
}  // namespace tactree::firmware
