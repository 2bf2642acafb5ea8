#pragma once
// Core registers of Cortex-M processors (Armv7-M and Armv8-M Architecture Reference Manuals,
// "System Control Space").

#include <cstdint>

namespace tactree::firmware::cortex_m {

inline volatile std::uint32_t& register_at(std::uint32_t address) {
  return *reinterpret_cast<volatile std::uint32_t*>(address);
}

inline volatile std::uint32_t& systick_control() { return register_at(0xE000E010); }
inline volatile std::uint32_t& systick_reload() { return register_at(0xE000E014); }
inline volatile std::uint32_t& systick_value() { return register_at(0xE000E018); }
/// SysTick enabled, with interrupt, on the core clock.
inline constexpr std::uint32_t kSystickOn = 0x7;

inline volatile std::uint32_t& interrupt_control() { return register_at(0xE000ED04); }
inline constexpr std::uint32_t kPendPendsv = 1U << 28;

inline volatile std::uint32_t& vector_table() { return register_at(0xE000ED08); }

/// Priorities of the system handlers: SysTick in the highest byte, then PendSV.
inline volatile std::uint32_t& handler_priority_3() { return register_at(0xE000ED20); }
inline constexpr std::uint32_t kPendsvLowest = 0xFFU << 16;

inline volatile std::uint32_t& handler_control() { return register_at(0xE000ED24); }
inline constexpr std::uint32_t kMemoryBusUsageFaults = 0x7U << 16;

inline volatile std::uint32_t& coprocessor_access() { return register_at(0xE000ED88); }
inline constexpr std::uint32_t kFpuFullAccess = 0xFU << 20;

/// Memory protection (Armv7-M Architecture Reference Manual, B3.5).
inline volatile std::uint32_t& mpu_control() { return register_at(0xE000ED94); }
inline constexpr std::uint32_t kMpuOnWithDefaultMap = 0x5;
inline volatile std::uint32_t& mpu_region_number() { return register_at(0xE000ED98); }
inline volatile std::uint32_t& mpu_region_base() { return register_at(0xE000ED9C); }
inline volatile std::uint32_t& mpu_region_attributes() { return register_at(0xE000EDA0); }

/// A read-only region of 128 KiB. Each bit set in `without` excludes one of its eight subregions.
struct ReadOnlyRegion {
  std::uint32_t base;
  std::uint32_t without;
  bool executable;
};
inline void protect(std::uint32_t number, const ReadOnlyRegion& region) {
  constexpr std::uint32_t kEnabled128K = 16U << 1U | 1U;
  constexpr std::uint32_t kInternalRam = 6U << 16U;  // shareable, write-through
  constexpr std::uint32_t kReadOnly = 6U << 24U;
  constexpr std::uint32_t kNeverExecute = 1U << 28U;
  mpu_region_number() = number;
  mpu_region_base() = region.base;
  mpu_region_attributes() = kEnabled128K | region.without << 8U | kInternalRam | kReadOnly |
                            (region.executable ? 0U : kNeverExecute);
}

inline void synchronise() { __asm volatile("dsb\n\tisb" ::: "memory"); }

}  // namespace tactree::firmware::cortex_m
