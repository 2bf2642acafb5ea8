#pragma once
// Sectors of the chip's flash as hal::Flash.
// Loop and memory annotations: docs/BOUND.md.

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>

#include "stm32f4/flash_programmer.hpp"
#include "tactree/hal/flash.hpp"

namespace tactree::firmware::stm32f4 {

/// Actions of a board around an erase, during which the processor stalls for up to 2 s.
///   begin()  switches the motors off, holds the ticks and extends the watchdog's timeout. If it
///            returns false, nothing is erased.
///   end()    restores the timeout and releases the ticks. Called after each begin().
template <class T>
concept Standstill = requires(T& standstill) {
  { standstill.begin() }
  noexcept->std::same_as<bool>;
  { standstill.end() }
  noexcept->std::same_as<void>;
};

/// First word of the whole flash, for writing and for reading. `Cell` is the type of a word of
/// flash (FlashProgrammer).
template <class Cell>
struct FlashCells {
  Cell* cells = nullptr;
  const std::byte* bytes = nullptr;
};

/// The flash of this chip.
inline FlashCells<HardwareWord> flash_cells() {
  const std::uintptr_t begin = address::kFlashBegin;
  return {reinterpret_cast<HardwareWord*>(begin), reinterpret_cast<const std::byte*>(begin)};
}

template <class Word, class Cell, class S>
class StoreFlash {
 public:
  StoreFlash(FlashBlock<Word>& block, const FlashCells<Cell>& flash, const FlashRegion& region,
             S& standstill)
      : programmer_(block, flash.cells + begin_of(region) / 4U, region),
        bytes_(flash.bytes + begin_of(region)),
        region_(region),
        standstill_(standstill) {}

  [[nodiscard]] hal::FlashGeometry geometry() const noexcept {
    return {4U * region_.words_per_sector, region_.sectors, 4};
  }
  [[nodiscard]] std::span<const std::byte> bytes() const noexcept {
    return {bytes_, std::size_t{4} * region_.words_per_sector * region_.sectors};
  }

  [[nodiscard]] bool erase(std::uint32_t sector) noexcept {
    static_assert(Standstill<S>);
    const bool ready = standstill_.begin();
    const bool erased = ready && programmer_.erase(sector) == FlashStatus::kOk;
    standstill_.end();
    return erased;
  }

  /// Ticks continue during programming, because a word takes at most 0.1 ms.
  [[nodiscard]] bool program(std::uint32_t offset, std::span<const std::byte> bytes) noexcept {
    std::uint32_t words[16];
    if (offset % 4U != 0U || bytes.size() % 4U != 0U) {
      return false;
    }
    while (!bytes.empty()) {  // bound: bytes_size / 4
      const std::size_t size = bytes.size() < sizeof words ? bytes.size() : sizeof words;
      __builtin_memcpy(words, bytes.data(), size);
      if (programmer_.program(offset / 4U, std::span(words).first(size / 4U)) != FlashStatus::kOk) {
        return false;
      }
      offset += static_cast<std::uint32_t>(size);
      bytes = bytes.subspan(size);
    }
    return true;
  }

 private:
  FlashProgrammer<Word, Cell> programmer_;
  const std::byte* bytes_;
  FlashRegion region_;
  S& standstill_;
};

}  // namespace tactree::firmware::stm32f4
