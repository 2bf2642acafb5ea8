#include "tactree/emulation/board_description.hpp"

namespace tactree::emulation {
namespace {

constexpr std::uint32_t kMiB = 1U << 20;

// The addresses are those of firmware/boards/<name>/memory.ld; an image with other addresses is
// refused. No emulator models the timers and the USART that the image of the stm32f405 uses, nor
// the STM32H743 and the RP2350. The Netduino Plus 2 has the chip of the stm32f405 and is emulated.
constexpr BoardDescription kBoards[] = {
    {"mps2-an500", "Cortex-M7", "cortex-m7", "qemu-system-arm", "qemu-system-arm", "-M mps2-an500",
     0x60000000, 16 * kMiB, 1, true},
    {"mps2-an386", "Cortex-M4F", "cortex-m4f", "qemu-system-arm", "qemu-system-arm",
     "-M mps2-an386", 0x21000000, 16 * kMiB, 3, true},
    {"mps2-an505", "Cortex-M33", "cortex-m33", "qemu-system-arm", "qemu-system-arm",
     "-M mps2-an505", 0x80000000, 16 * kMiB, 3, true},
    {"mps3-an547", "Cortex-M55", "cortex-m55", "qemu-system-arm", "qemu-system-arm",
     "-M mps3-an547", 0x70000000, 256 * kMiB, 2, true},
    {"netduinoplus2", "STM32F405, Cortex-M4F", "cortex-m4f", "qemu-system-arm", "qemu-system-arm",
     "-M netduinoplus2", 0x08020000, 896 << 10, 3, false},
    {"stm32f405", "STM32F405, Cortex-M4F", "cortex-m4f", nullptr, nullptr, nullptr, 0x08020000,
     384 << 10, 0, false},
    {"stm32h743", "STM32H743, Cortex-M7", "cortex-m7", nullptr, nullptr, nullptr, 0x08020000,
     1920 << 10, 0, false},
    {"rp2350", "RP2350, Cortex-M33", "cortex-m33", nullptr, nullptr, nullptr, 0x10040000,
     3840 << 10, 0, false},
    {"rv32-virt", "RISC-V rv32imafc", "rv32imafc", "qemu-system-riscv32", "qemu-system-misc",
     "-M virt -cpu sifive-e34 -bios none -m 512M", 0x81000000, 256 * kMiB, 2, true},
};

}  // namespace

std::span<const BoardDescription> boards() { return kBoards; }

const BoardDescription* find_board(std::string_view name) {
  for (const BoardDescription& board : kBoards) {
    if (name == board.name) {
      return &board;
    }
  }
  return nullptr;
}

}  // namespace tactree::emulation
