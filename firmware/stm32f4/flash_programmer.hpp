#pragma once
// Erasing and programming the chip's flash (RM0090, sections 3.6 and 3.9). While the flash is busy
// the processor cannot fetch from it and stands still: an erase takes up to 2 s. So: motors off,
// and a watchdog that waits as long (store_flash.hpp).

#include <cstdint>
#include <span>

#include "stm32f4/bits.hpp"
#include "stm32f4/registers.hpp"

namespace tactree::firmware::stm32f4 {

enum class FlashStatus : std::uint8_t {
  kOk = 0,
  kOutside,    ///< not within the region; nothing was touched
  kLocked,     ///< the keys were not taken
  kTimeout,    ///< busy for longer than the data sheet allows
  kProtected,  ///< the sector is write-protected
  kRefused,    ///< alignment, size or sequence error
  kReadBack,   ///< the flash does not hold what was written, or is not erased
};

/// Sectors of equal size that follow each other. On an STM32F405 0 to 3 have 16 KiB, 4 has 64 KiB,
/// 5 to 11 have 128 KiB (table 5).
struct FlashRegion {
  std::uint32_t first_sector = 5;
  std::uint32_t sectors = 7;
  std::uint32_t words_per_sector = 32768;
};

/// Bytes of the flash before it.
constexpr std::uint32_t begin_of(const FlashRegion& region) {
  const std::uint32_t first = region.first_sector;
  return first < 5U ? first * 0x4000U : 0x20000U + (first - 5U) * 0x20000U;
}

/// Reads of the status before it is a timeout. A poll takes ten cycles or more: data sheet, table
/// 38, gives 2 s for a sector and 0.1 ms for a word.
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

/// `Cell` is a word of the flash itself, `Word` one of its registers.
template <class Word, class Cell = Word>
class FlashProgrammer {
 public:
  /// `cells` is the first word of the region.
  FlashProgrammer(FlashBlock<Word>& block, Cell* cells, const FlashRegion& region,
                  const FlashPatience& patience = {})
      : block_(block), cells_(cells), region_(region), patience_(patience) {}

  /// All words of a sector become 0xFFFFFFFF; read back. The region's first sector is 0.
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

  /// Writes words from the word `offset` of the region on, reading each back. Stops at the first
  /// that fails. Bits go from 1 to 0 only: erase first.
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

  // Not busy, unlocked, and no error of former times. The data cache may hold what is about to
  // change: it is off until close(), which also clears it (section 3.5.2).
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
    block_.sr = flash::kErrors | flash::kDone;  // a one clears
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

  // Locked again whatever happened; but while the flash is busy, a write to its register would hold
  // up the processor (section 3.9.5).
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
