#pragma once
// The record of a ModelStore: the slot in use, the contents of the slots, the saved parameters. The
// layout is that in flash. docs/PROTOCOL.md explains why power may be lost at any time.

#include <cstdint>

#include "tactree/core/configuration/parameters.hpp"

namespace tactree::store {

inline constexpr std::uint32_t kRecordMagic = 0x54435231;
inline constexpr std::uint32_t kStoreSlots = 2;
inline constexpr std::uint32_t kFactorySlot = 0xFFFFFFFF;  ///< the model in the image, if any

/// Properties of the model in a slot, as they were checked.
struct SlotEntry {
  char board[24] = {};
  std::uint32_t bytes = 0;  ///< 0: the slot is empty
  std::uint32_t checksum = 0;
  std::uint32_t counter = 0;
  std::uint32_t is_signed = 0;
  std::uint8_t signature[64] = {};
};

struct ModelRecord {
  std::uint32_t magic = kRecordMagic;
  std::uint32_t sequence = 0;  ///< the newest valid record is used
  std::uint32_t active = kFactorySlot;
  std::uint32_t counter_min = 0;  ///< maximum counter of the signed models that were used
  SlotEntry slot[kStoreSlots]{};
  std::uint32_t has_parameters = 0;
  float parameter[core::kParameters] = {};
  std::uint32_t reserved[4] = {};
  std::uint32_t checksum = 0;  ///< CRC-32 of all preceding bytes
};
static_assert(sizeof(SlotEntry) == 104 && sizeof(ModelRecord) == 368);
/// Distance between records, bytes: a multiple of every permitted FlashGeometry::program_bytes.
inline constexpr std::uint32_t kRecordBytes = 384;
static_assert(sizeof(ModelRecord) <= kRecordBytes && kRecordBytes % 32 == 0);

[[nodiscard]] std::uint32_t checksum_of(const ModelRecord& record);

/// Returns true if magic and checksum are correct and every slot number and length is in range.
[[nodiscard]] bool is_valid(const ModelRecord& record, std::uint32_t slot_bytes);

/// Replaces the calibration in the image by the saved one. `saved`: kParameters values, or nullptr.
/// A value that is out of range is skipped.
void apply_saved_parameters(const float* saved, core::Configuration& configuration);

}  // namespace tactree::store
