#pragma once
// Registers of the core that every Cortex-M has (Armv7-M and Armv8-M Architecture Reference
// Manuals, "System Control Space").

#include <cstdint>

namespace tactree::firmware::cortex_m {

inline volatile std::uint32_t& register_at(std::uint32_t address) {
  return *reinterpret_cast<volatile std::uint32_t*>(address);
}

inline volatile std::uint32_t& systick_control() { return register_at(0xE000E010); }
inline volatile std::uint32_t& systick_reload() { return register_at(0xE000E014); }
inline volatile std::uint32_t& systick_value() { return register_at(0xE000E018); }
/// Enabled, with an interrupt, from the core's clock.
inline constexpr std::uint32_t kSystickOn = 0x7;
inline constexpr std::uint32_t kSystickReloadMax = 0xFFFFFF;

inline volatile std::uint32_t& interrupt_control() { return register_at(0xE000ED04); }
inline constexpr std::uint32_t kPendPendsv = 1U << 28;

inline volatile std::uint32_t& vector_table() { return register_at(0xE000ED08); }

inline volatile std::uint32_t& reset_control() { return register_at(0xE000ED0C); }
inline constexpr std::uint32_t kResetKeyAndRequest = 0x05FA0004;

/// Priorities of the system handlers: SysTick in the highest byte, then PendSV.
inline volatile std::uint32_t& handler_priority_3() { return register_at(0xE000ED20); }
inline constexpr std::uint32_t kPendsvLowest = 0xFFU << 16;

inline volatile std::uint32_t& handler_control() { return register_at(0xE000ED24); }
inline constexpr std::uint32_t kMemoryBusUsageFaults = 0x7U << 16;

inline volatile std::uint32_t& fault_status() { return register_at(0xE000ED28); }
inline volatile std::uint32_t& memory_fault_address() { return register_at(0xE000ED34); }
inline volatile std::uint32_t& bus_fault_address() { return register_at(0xE000ED38); }
inline constexpr std::uint32_t kMemoryAddressValid = 1U << 7;
inline constexpr std::uint32_t kBusAddressValid = 1U << 15;

inline volatile std::uint32_t& coprocessor_access() { return register_at(0xE000ED88); }
inline constexpr std::uint32_t kFpuFullAccess = 0xFU << 20;

inline void synchronise() { __asm volatile("dsb\n\tisb" ::: "memory"); }

}  // namespace tactree::firmware::cortex_m
