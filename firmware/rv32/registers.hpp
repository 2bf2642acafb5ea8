#pragma once
// Machine-mode registers (RISC-V privileged architecture) and registers of QEMU's virt machine: the
// CLINT timer, which runs at 10 MHz, and the test device, which resets the machine.

#include <cstdint>

namespace tactree::firmware::rv32 {

inline volatile std::uint32_t& register_at(std::uint32_t address) {
  return *reinterpret_cast<volatile std::uint32_t*>(address);
}

inline volatile std::uint32_t& timer_compare_low() { return register_at(0x02004000); }
inline volatile std::uint32_t& timer_compare_high() { return register_at(0x02004004); }
inline volatile std::uint32_t& timer_low() { return register_at(0x0200BFF8); }
inline volatile std::uint32_t& timer_high() { return register_at(0x0200BFFC); }

inline volatile std::uint32_t& test_device() { return register_at(0x00100000); }
inline constexpr std::uint32_t kTestDeviceReset = 0x7777;

inline constexpr std::uint32_t kStatusInterrupts = 1U << 3;                   // mstatus.MIE
inline constexpr std::uint32_t kStatusFpuInitial = 1U << 13;                  // mstatus.FS
inline constexpr std::uint32_t kNoAccessNapotLocked = (1U << 7) | (3U << 3);  // pmpcfg: L, A
inline constexpr std::uint32_t kTimerInterrupt = 1U << 7;                     // mie.MTIE

}  // namespace tactree::firmware::rv32
