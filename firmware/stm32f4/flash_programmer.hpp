#pragma once
// Erases and programs the flash of the chip (RM0090, sections 3.6 and 3.9). While the flash is busy
// the processor cannot fetch from it and stalls, for up to 2 s during an erase. Preconditions: the
// motors are off and the watchdog's timeout is extended (store_flash.hpp).
// Loop and memory annotations: docs/BOUND.md.

#include <cstdint>
#include <span>

#include "stm32f4/bits.hpp"
#include "stm32f4/registers.hpp"

namespace tactree::firmware::stm32f4 {

enum class FlashStatus : std::uint8_t {
  kOk = 0,
  kOutside,    ///< not within the region; nothing was changed
  kLocked,     ///< the keys were rejected
  kTimeout,    ///< busy longer than the data sheet specifies
  kProtected,  ///< the sector is write-protected
  kRefused,    ///< alignment, size or sequence error
  kReadBack,   ///< content differs from the data written, or is not erased
};

/// Contiguous sectors of equal size. On an STM32F405, sectors 0 to 3 have 16 KiB, sector 4 has
/// 64 KiB, and sectors 5 to 11 have 128 KiB (table 5).
struct FlashRegion {
  std::uint32_t first_sector = 5;
  std::uint32_t sectors = 7;
  std::uint32_t words_per_sector = 32768;
};

/// Offset of the region in the flash, bytes.
constexpr std::uint32_t begin_of(const FlashRegion& region) {
  const std::uint32_t first = region.first_sector;
  return first < 5U ? first * 0x4000U : 0x20000U + (first - 5U) * 0x20000U;
}

/// Number of status reads before a timeout. A poll takes at least ten cycles, so these limits are
/// at least 2.9 s and 2.9 ms at 168 MHz. The data sheet, table 38, specifies 2 s for a sector and
/// 0.1 ms for a word.
struct FlashPatience {
  std::uint32_t erase_polls = 50000000;
  std::uint32_t program_polls = 50000;
};

namespace flash {
inline constexpr std::uint32_t kKey1 = 0x45670123;
inline constexpr std::uint32_t kKey2 = 0xCDEF89AB;
inline constexpr std::uint32_t kLock = 1U << 31;
inline constexpr std::uint32_t kProgram = 1U << 0;
inline constexpr std::uint32_t kSectorErase = 1U << 1;
inline constexpr std::uint32_t kSectorShift = 3;
inline constexpr std::uint32_t kWordSize = 0x2U << 8;  // 2.7 .. 3.6 V
inline constexpr std::uint32_t kStart = 1U << 16;
inline constexpr std::uint32_t kBusy = 1U << 16;
inline constexpr std::uint32_t kProtectionError = 1U << 4;
inline constexpr std::uint32_t kErrors = 0xF2U;
inline constexpr std::uint32_t kDone = 1U << 0;
inline constexpr std::uint32_t kDataCacheOn = 1U << 10;
inline constexpr std::uint32_t kDataCacheReset = 1U << 12;
inline constexpr std::uint32_t kErased = 0xFFFFFFFF;
}  // namespace flash

/// `Cell` is the type of a word of flash, `Word` that of a register. Use outside the tick only.
template <class Word, class Cell = Word>
class FlashProgrammer {
 public:
  /// `cells` is the first word of the region.
  FlashProgrammer(FlashBlock<Word>& block, Cell* cells, const FlashRegion& region,
                  const FlashPatience& patience = {})
      : block_(block), cells_(cells), region_(region), patience_(patience) {}

  /// Erases a sector, whose words then read 0xFFFFFFFF, and checks this. `sector` counts from 0 in
  /// the region.
  [[nodiscard]] FlashStatus erase(std::uint32_t sector) {
    if (sector >= region_.sectors) {
      return FlashStatus::kOutside;
    }
    FlashStatus status = open();
    if (status == FlashStatus::kOk) {
      const std::uint32_t number = region_.first_sector + sector;
      block_.cr = flash::kSectorErase | flash::kWordSize | (number << flash::kSectorShift);
      set(block_.cr, flash::kStart);
      status = finish(patience_.erase_polls);
    }
    close();
    return status == FlashStatus::kOk && !is_erased(sector) ? FlashStatus::kReadBack : status;
  }

  /// Writes words from word `offset` of the region and reads each back. Stops at the first failure.
  /// Precondition: the words are erased, as programming changes bits from 1 to 0 only.
  [[nodiscard]] FlashStatus program(std::uint32_t offset, std::span<const std::uint32_t> words) {
    const std::uint32_t size = region_.sectors * region_.words_per_sector;
    if (offset > size || words.size() > size - offset) {
      return FlashStatus::kOutside;
    }
    FlashStatus status = open();
    for (std::size_t i = 0; status == FlashStatus::kOk && i < words.size(); ++i) {  // bound: words
      status = program_word(cells_[offset + i], words[i]);
    }
    close();
    return status;
  }

 private:
  FlashStatus program_word(Cell& cell, std::uint32_t word) {
    block_.cr = flash::kProgram | flash::kWordSize;
    cell = word;
    const FlashStatus status = finish(patience_.program_polls);
    return status == FlashStatus::kOk && read(cell) != word ? FlashStatus::kReadBack : status;
  }

  // Waits until the flash is not busy, unlocks it and clears old errors. Disables the data cache,
  // which may hold bytes that will change; close() clears and enables it again (section 3.5.2).
  FlashStatus open() {
    if (!wait_until(block_.sr, flash::kBusy, 0U, patience_.erase_polls)) {
      return FlashStatus::kTimeout;
    }
    clear(block_.acr, flash::kDataCacheOn);
    if (has(block_.cr, flash::kLock)) {
      block_.keyr = flash::kKey1;
      block_.keyr = flash::kKey2;
    }
    if (has(block_.cr, flash::kLock)) {
      return FlashStatus::kLocked;
    }
    block_.sr = flash::kErrors | flash::kDone;  // write 1 to clear
    return FlashStatus::kOk;
  }

  FlashStatus finish(std::uint32_t polls) {
    if (!wait_until(block_.sr, flash::kBusy, 0U, polls)) {
      return FlashStatus::kTimeout;
    }
    const std::uint32_t errors = read(block_.sr) & flash::kErrors;
    if (errors == 0U) {
      return FlashStatus::kOk;
    }
    return (errors & flash::kProtectionError) != 0U ? FlashStatus::kProtected
                                                    : FlashStatus::kRefused;
  }

  // Locks the flash after a success or a failure. If the flash is still busy, it stays unlocked,
  // because a write to its register would stall the processor (section 3.9.5).
  void close() {
    if (has(block_.sr, flash::kBusy)) {
      return;
    }
    block_.cr = flash::kLock;
    set(block_.acr, flash::kDataCacheReset);
    clear(block_.acr, flash::kDataCacheReset);
    set(block_.acr, flash::kDataCacheOn);
  }

  bool is_erased(std::uint32_t sector) const {
    const Cell* cells = cells_ + sector * region_.words_per_sector;
    for (std::uint32_t i = 0; i < region_.words_per_sector; ++i) {  // bound: words_per_sector
      if (read(cells[i]) != flash::kErased) {
        return false;
      }
    }
    return true;
  }

  FlashBlock<Word>& block_;
  Cell* cells_;
  FlashRegion region_;
  FlashPatience patience_;
};

}  // namespace tactree::firmware::stm32f4
