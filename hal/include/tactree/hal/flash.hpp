#pragma once
// Flash area for models and parameters. All functions are called from one context.

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>

namespace tactree::hal {

/// Geometry of the area. All sectors have the same size.
struct FlashGeometry {
  std::uint32_t sector_bytes = 4096;  ///< smallest erasable unit; a multiple of 512
  std::uint32_t sectors = 0;          ///< at least 4; at least 2 for records only or models only
  std::uint32_t program_bytes = 4;    ///< smallest writable unit: 1 .. 32, power of 2
};

/// NOR flash: erased bytes are 0xFF; written bytes stay until their sector is erased.
///   geometry()              returns the geometry, which is constant.
///   bytes()                 returns the whole area, readable in place, 4-byte aligned.
///   erase(sector)           erases a sector and waits for completion; returns false on failure.
///   program(offset, bytes)  writes to erased bytes and waits for completion; returns false on
///                           failure. Offset and size must be multiples of program_bytes.
/// A reset during an operation leaves its sector or unit with arbitrary content.
template <class T>
concept Flash = requires(T& flash, const T& flash_to_read, std::uint32_t number,
                         std::span<const std::byte> bytes) {
  { flash_to_read.geometry() }
  noexcept->std::same_as<FlashGeometry>;
  { flash_to_read.bytes() }
  noexcept->std::same_as<std::span<const std::byte>>;
  { flash.erase(number) }
  noexcept->std::same_as<bool>;
  { flash.program(number, bytes) }
  noexcept->std::same_as<bool>;
};

}  // namespace tactree::hal
