#pragma once
// QEMU's RISC-V virt machine with a sifive-e34 core, rv32imafc.

#include "plant_link/uart_board.hpp"
#include "uarts/ns16550_uart.hpp"

namespace tactree::firmware {
using Board = UartBoard<Ns16550Uart<0x10000000>>;
}  // namespace tactree::firmware
