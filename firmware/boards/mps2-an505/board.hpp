#pragma once
// Arm MPS2+ with the Cortex-M33 image AN505, in QEMU. All code runs in the Secure state.

#include "plant_link/uart_board.hpp"
#include "uarts/cmsdk_uart.hpp"

namespace tactree::firmware {
using Board = UartBoard<CmsdkUart<0x50200000>>;
}  // namespace tactree::firmware
