#pragma once
// The record of a ModelStore: which slot is in use, what the slots hold, and the parameters. Laid
// out as in flash; docs/PROTOCOL.md tells why it is safe to lose power at any time.

#include <cstddef>
#include <cstdint>
#include <span>

#include "tactree/core/crc32.hpp"
#include "tactree/core/parameters.hpp"

namespace tactree::hal {

inline constexpr std::uint32_t kRecordMagic = 0x54435231;
inline constexpr std::uint32_t kStoreSlots = 2;
inline constexpr std::uint32_t kFactorySlot = 0xFFFFFFFF;  ///< the model in the image, if any

/// What a slot holds, as it was checked.
struct SlotEntry {
  char board[24] = {};
  std::uint32_t bytes = 0;  ///< 0: nothing
  std::uint32_t checksum = 0;
  std::uint32_t counter = 0;
  std::uint32_t is_signed = 0;
  std::uint8_t signature[64] = {};
};

struct ModelRecord {
  std::uint32_t magic = kRecordMagic;
  std::uint32_t sequence = 0;  ///< of the records the one with the largest counts
  std::uint32_t active = kFactorySlot;
  std::uint32_t counter_min = 0;  ///< largest counter of a signed model that was used
  SlotEntry slot[kStoreSlots]{};
  std::uint32_t has_parameters = 0;
  float parameter[core::kParameters] = {};
  std::uint32_t reserved[4] = {};
  std::uint32_t checksum = 0;  ///< CRC-32 of all before it
};
static_assert(sizeof(SlotEntry) == 104 && sizeof(ModelRecord) == 368);
/// Each record has a place of its own, a multiple of all piece sizes of flash.
inline constexpr std::uint32_t kRecordBytes = 384;
static_assert(sizeof(ModelRecord) <= kRecordBytes && kRecordBytes % 32 == 0);

inline std::uint32_t checksum_of(const ModelRecord& record) {
  const auto bytes = std::as_bytes(std::span(&record, 1));
  return core::crc32(bytes.first(sizeof record - sizeof record.checksum));
}

/// Nothing in it can lead outside of the slots.
inline bool is_valid(const ModelRecord& record, std::uint32_t slot_bytes) {
  return record.magic == kRecordMagic && record.checksum == checksum_of(record) &&
         (record.active < kStoreSlots || record.active == kFactorySlot) &&
         record.slot[0].bytes <= slot_bytes && record.slot[1].bytes <= slot_bytes;
}

}  // namespace tactree::hal
