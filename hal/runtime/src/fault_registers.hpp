#pragma once
// Core registers of Cortex-M processors for the record of a fault (Armv7-M and Armv8-M Architecture
// Reference Manuals, "System Control Space").

#include <cstdint>

namespace tactree::runtime {

inline volatile std::uint32_t& register_at(std::uint32_t address) {
  return *reinterpret_cast<volatile std::uint32_t*>(address);
}

inline volatile std::uint32_t& reset_control() { return register_at(0xE000ED0C); }
inline constexpr std::uint32_t kResetKeyAndRequest = 0x05FA0004;

inline volatile std::uint32_t& fault_status() { return register_at(0xE000ED28); }
inline volatile std::uint32_t& memory_fault_address() { return register_at(0xE000ED34); }
inline volatile std::uint32_t& bus_fault_address() { return register_at(0xE000ED38); }
inline constexpr std::uint32_t kMemoryAddressValid = 1U << 7;
inline constexpr std::uint32_t kBusAddressValid = 1U << 15;

inline void synchronise() { __asm volatile("dsb\n\tisb" ::: "memory"); }

}  // namespace tactree::runtime
