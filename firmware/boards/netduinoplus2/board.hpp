#pragma once
// Netduino Plus 2: an STM32F405, Cortex-M4 with FPU at 168 MHz, in QEMU; its plant over the link.

#include "plant_link/served_board.hpp"
#include "uarts/stm32_usart.hpp"

namespace tactree::firmware {
using Board = ServedBoard<Stm32Usart<0x40011000>, ImageStore>;
}  // namespace tactree::firmware
