#pragma once
// The flash as RM0090 tells, sections 3.5 to 3.9: locked until two keys came in order, busy for a
// while, bits that only go from 1 to 0, whole sectors to erase, and a data cache that does not
// notice.

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "fake_word.hpp"
#include "stm32f4/flash_programmer.hpp"

namespace tactree::test {

class FakeFlash {
 public:
  static constexpr std::uint32_t kSectors = 3;
  static constexpr std::uint32_t kWords = 8;  ///< in a sector

  // Imperfections.
  std::uint32_t busy_polls = 5;
  bool never_ready = false;
  bool keys_work = true;
  std::optional<std::uint32_t> protected_sector;  ///< of the region
  std::optional<std::uint32_t> worn_cell;         ///< its lowest bit does not come back to 1

  std::string violation;  ///< what the manual forbids; empty: nothing was
  std::uint32_t operations = 0;
  firmware::stm32f4::FlashRegion region{5, kSectors, kWords};
  firmware::stm32f4::FlashBlock<FakeWord> block;
  std::unique_ptr<FakeWord[]> cells{new FakeWord[kSectors * kWords]};

  FakeFlash() : stored_(kSectors * kWords, 0U), cached_(kSectors * kWords) {
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
    for (std::uint32_t i = 0; i < kSectors * kWords; ++i) {
      cells[i].on_read = [this, i](std::uint32_t) { return fetch(i); };
      cells[i].on_write = [this, i](std::uint32_t, std::uint32_t word) { return write(i, word); };
    }
  }

  [[nodiscard]] bool locked() const { return (block.cr.value & kLock) != 0U; }
  /// What the flash holds, whatever the cache says.
  [[nodiscard]] std::uint32_t stored(std::uint32_t cell) const { return stored_[cell]; }

 private:
  static constexpr std::uint32_t kLock = 1U << 31, kBusy = 1U << 16, kFlags = 0xF3U;
  static constexpr std::uint32_t kDataCacheOn = 1U << 10, kDataCacheReset = 1U << 12;

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
      erase(((written >> 3) & 0xFU) - region.first_sector);
    }
    return written & ~(1U << 16);
  }

  void erase(std::uint32_t sector) {
    begin();
    if (sector >= kSectors) {
      violation = "a sector outside the region was erased";
      return;
    }
    if (protected_sector == sector) {
      block.sr.value |= 1U << 4;
      return;
    }
    for (std::uint32_t i = sector * kWords; i < (sector + 1U) * kWords; ++i) {
      stored_[i] = worn_cell == i ? 0xFFFFFFFEU : 0xFFFFFFFFU;
    }
  }

  std::uint32_t write(std::uint32_t cell, std::uint32_t word) {
    if (remaining_ > 0U) {
      violation = "the flash was written while busy";
    }
    if (locked() || (block.cr.value & 1U) == 0U) {
      block.sr.value |= 1U << 7;  // sequence
      return 0;
    }
    if (((block.cr.value >> 8) & 3U) != 2U) {
      block.sr.value |= 1U << 6;  // parallelism
      return 0;
    }
    begin();
    if (protected_sector == cell / kWords) {
      block.sr.value |= 1U << 4;
      return 0;
    }
    stored_[cell] &= word;
    return 0;
  }

  void begin() {
    ++operations;
    remaining_ = busy_polls;
  }

  std::uint32_t status(std::uint32_t value) {
    if (remaining_ > 0U && !never_ready) {
      --remaining_;
    }
    return remaining_ > 0U ? value | kBusy : value;
  }

  std::uint32_t access(std::uint32_t value, std::uint32_t written) {
    if ((written & kDataCacheReset) != 0U && (value & kDataCacheOn) == 0U) {
      cached_.assign(cached_.size(), std::nullopt);
    }
    return written;
  }

  std::uint32_t fetch(std::uint32_t cell) {
    if ((block.acr.value & kDataCacheOn) == 0U) {
      return stored_[cell];
    }
    if (!cached_[cell].has_value()) {
      cached_[cell] = stored_[cell];
    }
    return *cached_[cell];
  }

  std::vector<std::uint32_t> stored_;
  std::vector<std::optional<std::uint32_t>> cached_;
  std::uint32_t last_key_ = 0;
  std::uint32_t remaining_ = 0;
};

}  // namespace tactree::test
