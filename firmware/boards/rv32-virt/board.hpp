#pragma once
// RISC-V, rv32imafc: QEMU's virt machine with the core sifive-e34.

#include "plant_link/uart_board.hpp"
#include "uarts/ns16550_uart.hpp"

namespace tactree::firmware {
using Board = UartBoard<Ns16550Uart<0x10000000>>;
}  // namespace tactree::firmware
