#pragma once
// The part of a board's flash that keeps models.

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>

namespace tactree::hal {

/// All sectors are of one size.
struct FlashGeometry {
  std::uint32_t sector_bytes = 4096;  ///< smallest piece that can be erased; a multiple of 512
  std::uint32_t sectors = 0;          ///< at least 4; 2 of one that holds records, or models, only
  std::uint32_t program_bytes = 4;    ///< smallest piece that can be written: 1 .. 32, power of 2
};

/// NOR flash: erased bytes are 0xFF; what was written stays until its sector is erased.
///   geometry()              never changes.
///   bytes()                 all of it, to be read in place, 4-byte aligned.
///   erase(sector)           waits until it is done. False: it failed.
///   program(offset, bytes)  likewise. Both multiples of program_bytes, and erased before.
/// A reset at any moment leaves the sector or the piece at work with any content.
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
