#pragma once
// The record of a ModelStore: the slot in use, the contents of the slots, the saved parameters.
// Laid out as in flash. docs/PROTOCOL.md shows that power may be lost at any time.

#include <cstddef>
#include <cstdint>
#include <span>

#include "tactree/core/configuration/parameters.hpp"

namespace tactree::store {

inline constexpr std::uint32_t kRecordMagic = 0x54435231;
inline constexpr std::uint32_t kStoreSlots = 2;
inline constexpr std::uint32_t kFactorySlot = 0xFFFFFFFF;  ///< the model in the image, if any

/// The model in a slot, as it was checked.
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
  std::uint32_t sequence = 0;  ///< the valid record with the largest one counts
  std::uint32_t active = kFactorySlot;
  std::uint32_t counter_min = 0;  ///< largest counter of a signed model that was used
  SlotEntry slot[kStoreSlots]{};
  std::uint32_t has_parameters = 0;
  float parameter[core::kParameters] = {};
  std::uint32_t reserved[4] = {};
  std::uint32_t checksum = 0;  ///< CRC-32 of all before it
};
static_assert(sizeof(SlotEntry) == 104 && sizeof(ModelRecord) == 368);
/// Bytes from one record to the next: a multiple of every FlashGeometry::program_bytes.
inline constexpr std::uint32_t kRecordBytes = 384;
static_assert(sizeof(ModelRecord) <= kRecordBytes && kRecordBytes % 32 == 0);

[[nodiscard]] std::uint32_t checksum_of(const ModelRecord& record);

/// Checksum right, and every slot number and length within the slots.
[[nodiscard]] bool is_valid(const ModelRecord& record, std::uint32_t slot_bytes);

/// Replaces the calibration of the image by the saved one. `saved`: kParameters values, or nullptr.
/// A value that is out of its range is skipped.
void apply_saved_parameters(const float* saved, core::Configuration& configuration);

}  // namespace tactree::store
