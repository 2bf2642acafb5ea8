#pragma once
// Model of the flash of RM0090, sections 3.5 to 3.9: two keys unlock it, operations take time,
// programming changes bits from 1 to 0 only, sectors are erased as a whole, and the data cache is
// not coherent. A power cut at any operation leaves it incomplete.

#include <cstdint>
#include <cstring>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "fake_word.hpp"
#include "stm32f4/flash_programmer.hpp"
#include "stm32f4/store_flash.hpp"

namespace tactree::test {

class FakeFlash;

/// A word of the flash itself.
class FakeCell {
 public:
  operator std::uint32_t() const;
  FakeCell& operator=(std::uint32_t word);

 private:
  friend class FakeFlash;
  FakeFlash* flash_ = nullptr;
};

class FakeFlash {
 public:
  static constexpr std::uint32_t kSectors = 3;
  static constexpr std::uint32_t kWords = 8;  ///< in a sector
  static constexpr double kEraseUs = 2e6;     ///< at most: data sheet, table 38
  static constexpr double kProgramUs = 100;

  // Imperfections.
  std::uint32_t busy_polls = 5;
  bool never_ready = false;
  bool keys_work = true;
  std::optional<std::uint32_t> protected_sector;
  std::optional<std::uint32_t> worn_cell;  ///< its lowest bit does not come back to 1
  /// In the operation with this number, counted from 0. After it nothing is done any more.
  std::uint64_t power_goes_at = std::numeric_limits<std::uint64_t>::max();

  std::string violation;  ///< violation of the manual; empty: none
  std::uint64_t operations = 0;
  std::uint32_t erased = 0;                             ///< sectors
  std::function<void(double us)> pass = [](double) {};  ///< the processor stands still
  firmware::stm32f4::FlashRegion region{5, kSectors, kWords};
  firmware::stm32f4::FlashBlock<FakeWord> block;

  /// Words of each of the chip's sectors, of none of those that a test does without.
  explicit FakeFlash(std::vector<std::uint32_t> words = {0, 0, 0, 0, 0, kWords, kWords, kWords},
                     std::uint32_t content = 0U)
      : sector_words_(std::move(words)) {
    std::uint32_t size = 0;
    for (const std::uint32_t sector : sector_words_) {
      size += sector;
    }
    stored_.assign(size, content);
    cached_.resize(size);
    cells_ = std::make_unique<FakeCell[]>(size);
    for (std::uint32_t i = 0; i < size; ++i) {
      cells_[i].flash_ = this;
    }
    set_hooks();
  }
  FakeFlash(const FakeFlash&) = delete;

  /// All of an STM32F405, erased.
  static std::vector<std::uint32_t> whole_chip() {
    std::vector<std::uint32_t> words(12, 32768);
    words[0] = words[1] = words[2] = words[3] = 4096;
    words[4] = 16384;
    return words;
  }

  [[nodiscard]] FakeCell* cells() { return cells_.get(); }
  [[nodiscard]] firmware::stm32f4::FlashCells<FakeCell> whole() {
    return {cells_.get(), std::as_bytes(std::span(stored_)).data()};
  }
  [[nodiscard]] bool locked() const { return (block.cr.value & kLock) != 0U; }
  /// Content of the flash, without the cache.
  [[nodiscard]] std::uint32_t stored(std::uint32_t cell) const { return stored_[cell]; }
  [[nodiscard]] const std::vector<std::uint32_t>& content() const { return stored_; }
  /// A programmer at its pins wrote this.
  void restore(const std::vector<std::uint32_t>& content) { stored_ = content; }
  void put(std::uint32_t offset, std::span<const std::byte> bytes) {
    std::memcpy(std::as_writable_bytes(std::span(stored_)).data() + offset, bytes.data(),
                bytes.size());
  }

 private:
  friend class FakeCell;
  static constexpr std::uint32_t kLock = 1U << 31, kBusy = 1U << 16, kFlags = 0xF3U;
  static constexpr std::uint32_t kDataCacheOn = 1U << 10, kDataCacheReset = 1U << 12;

  void set_hooks() {
    block.cr.value = kLock;
    block.acr.value = kDataCacheOn;
    block.keyr.on_write = [this](std::uint32_t, std::uint32_t key) { return take_key(key); };
    block.cr.on_write = [this](std::uint32_t value, std::uint32_t written) {
      return control(value, written);
    };
    block.sr.on_read = [this](std::uint32_t value) { return status(value); };
    block.sr.on_write = [](std::uint32_t value, std::uint32_t written) {
      return value & ~(written & kFlags);
    };
    block.acr.on_write = [this](std::uint32_t value, std::uint32_t written) {
      return access(value, written);
    };
  }

  std::uint32_t take_key(std::uint32_t key) {
    if (!keys_work) {
      return 0;
    }
    if (key == 0xCDEF89ABU && last_key_ == 0x45670123U) {
      block.cr.value &= ~kLock;
    }
    last_key_ = key;
    return 0;
  }

  std::uint32_t control(std::uint32_t value, std::uint32_t written) {
    if (remaining_ > 0U) {
      violation = "CR written while busy";
    }
    if ((value & kLock) != 0U) {
      return value;
    }
    if ((written & (1U << 16)) != 0U && (written & (1U << 1)) != 0U) {
      erase((written >> 3) & 0xFU);
    }
    return written & ~(1U << 16);
  }

  [[nodiscard]] std::uint32_t first_cell(std::uint32_t sector) const {
    std::uint32_t first = 0;
    for (std::uint32_t i = 0; i < sector; ++i) {
      first += sector_words_[i];
    }
    return first;
  }

  void erase(std::uint32_t sector) {
    const bool has_power = begin(kEraseUs);
    if (sector >= sector_words_.size() || sector_words_[sector] == 0U) {
      violation = "a sector outside the region was erased";
      return;
    }
    if (protected_sector == sector) {
      block.sr.value |= 1U << 4;
      return;
    }
    if (operations - 1U > power_goes_at) {
      return;
    }
    ++erased;
    const std::uint32_t first = first_cell(sector);
    const std::uint32_t count = has_power ? sector_words_[sector] : sector_words_[sector] / 2U;
    for (std::uint32_t i = first; i < first + count; ++i) {
      stored_[i] = worn_cell == i ? 0xFFFFFFFEU : 0xFFFFFFFFU;
    }
  }

  void write(std::uint32_t cell, std::uint32_t word) {
    if (remaining_ > 0U) {
      violation = "the flash was written while busy";
    }
    if (locked() || (block.cr.value & 1U) == 0U) {
      block.sr.value |= 1U << 7;  // sequence
      return;
    }
    if (((block.cr.value >> 8) & 3U) != 2U) {
      block.sr.value |= 1U << 6;  // parallelism
      return;
    }
    const bool has_power = begin(kProgramUs);
    if (protected_sector.has_value() && cell >= first_cell(*protected_sector) &&
        cell < first_cell(*protected_sector + 1U)) {
      block.sr.value |= 1U << 4;
      return;
    }
    if (operations - 1U <= power_goes_at) {
      stored_[cell] &= has_power ? word : word | 0xFFFF0000U;
    }
  }

  // False: the power goes in this one, or is gone.
  bool begin(double us) {
    const bool has_power = operations < power_goes_at;
    ++operations;
    remaining_ = busy_polls;
    pass(us);
    return has_power;
  }

  std::uint32_t status(std::uint32_t value) {
    if (remaining_ > 0U && !never_ready) {
      --remaining_;
    }
    return remaining_ > 0U ? value | kBusy : value;
  }

  std::uint32_t access(std::uint32_t value, std::uint32_t written) {
    if ((written & kDataCacheReset) != 0U && (value & kDataCacheOn) == 0U) {
      for (const std::uint32_t cell : in_cache_) {
        cached_[cell] = std::nullopt;
      }
      in_cache_.clear();
    }
    return written;
  }

  std::uint32_t fetch(std::uint32_t cell) {
    if ((block.acr.value & kDataCacheOn) == 0U) {
      return stored_[cell];
    }
    if (!cached_[cell].has_value()) {
      cached_[cell] = stored_[cell];
      in_cache_.push_back(cell);
    }
    return *cached_[cell];
  }

  std::vector<std::uint32_t> sector_words_;
  std::vector<std::uint32_t> stored_;
  std::vector<std::optional<std::uint32_t>> cached_;
  std::vector<std::uint32_t> in_cache_;
  std::unique_ptr<FakeCell[]> cells_;
  std::uint32_t last_key_ = 0;
  std::uint32_t remaining_ = 0;
};

inline FakeCell::operator std::uint32_t() const {
  return flash_->fetch(static_cast<std::uint32_t>(this - flash_->cells_.get()));
}
inline FakeCell& FakeCell::operator=(std::uint32_t word) {
  flash_->write(static_cast<std::uint32_t>(this - flash_->cells_.get()), word);
  return *this;
}

}  // namespace tactree::test
