#pragma once
// A log of records in the first two sectors of a flash. A record is appended after the newest one;
// when the sector is full, the other sector is erased and used. The sector of the newest record is
// never erased, so after a power cut at any time the newest record or its successor is valid.
// Loop and memory annotations: docs/BOUND.md.

#include <cstddef>
#include <cstdint>
#include <span>

#include "tactree/hal/flash.hpp"
#include "tactree/store/model_record.hpp"

namespace tactree::store {

template <hal::Flash F>
class RecordLog {
 public:
  explicit RecordLog(F& flash) : flash_(flash) {}

  enum class Found : std::uint8_t {
    kRecord,
    kNothing,  ///< never written, or the very first write was interrupted
    kDamaged,  ///< written, but no record is valid
  };

  /// Finds the newest valid record. Cost: reads two sectors. Not inlined, because a record takes
  /// much stack.
  [[gnu::noinline]] Found find(std::uint32_t slot_bytes, ModelRecord& record) {
    newest_ = kNone;
    std::uint32_t used = 0;
    for (std::uint32_t place = 0; place < 2U * places_per_sector(); ++place) {  // bound: places
      ModelRecord read;
      __builtin_memcpy(&read, bytes_of(place).data(), sizeof read);
      used += is_blank(place) ? 0U : 1U;
      const bool newer = newest_ == kNone || is_later(read.sequence, record.sequence);
      if (is_valid(read, slot_bytes) && newer) {
        record = read;
        newest_ = place;
      }
    }
    if (newest_ != kNone) {
      return Found::kRecord;
    }
    return used <= 1U ? Found::kNothing : Found::kDamaged;
  }

  /// Writes `record` as the newest. Returns false on failure; the preceding record then stays in
  /// use.
  [[nodiscard]] bool append(ModelRecord& record) {
    ++record.sequence;
    record.checksum = checksum_of(record);
    std::uint32_t place = 0;
    if (!find_place(place)) {
      return false;
    }
    alignas(4) std::byte image[kRecordBytes];
    for (std::byte& byte : image) {  // bound: kRecordBytes
      byte = std::byte{0xFF};
    }
    __builtin_memcpy(image, &record, sizeof record);
    if (!flash_.program(offset_of(place), image) ||
        __builtin_memcmp(bytes_of(place).data(), image, sizeof image) != 0) {
      return false;
    }
    newest_ = place;
    return true;
  }

 private:
  static constexpr std::uint32_t kNone = 0xFFFFFFFF;

  static bool is_later(std::uint32_t a, std::uint32_t b) { return a != b && a - b < 0x80000000U; }
  [[nodiscard]] std::uint32_t places_per_sector() const {
    return flash_.geometry().sector_bytes / kRecordBytes;
  }
  [[nodiscard]] std::uint32_t offset_of(std::uint32_t place) const {
    const std::uint32_t per_sector = places_per_sector();
    return place / per_sector * flash_.geometry().sector_bytes + place % per_sector * kRecordBytes;
  }
  [[nodiscard]] std::span<const std::byte> bytes_of(std::uint32_t place) const {
    return flash_.bytes().subspan(offset_of(place), kRecordBytes);
  }
  [[nodiscard]] bool is_blank(std::uint32_t place) const {
    for (const std::byte byte : bytes_of(place)) {  // bound: kRecordBytes
      if (byte != std::byte{0xFF}) {
        return false;
      }
    }
    return true;
  }

  // Finds the first blank position after the newest record, or erases the other sector and returns
  // its first position.
  [[nodiscard]] bool find_place(std::uint32_t& place) {
    const std::uint32_t per_sector = places_per_sector();
    const std::uint32_t sector = newest_ == kNone ? 1U : newest_ / per_sector;
    place = newest_ == kNone ? 2U * per_sector : newest_ + 1U;
    while (place < (sector + 1U) * per_sector) {  // bound: places
      if (is_blank(place)) {
        return true;
      }
      ++place;
    }
    place = (1U - sector) * per_sector;
    return flash_.erase(1U - sector);
  }

  F& flash_;
  std::uint32_t newest_ = kNone;
};

}  // namespace tactree::store
