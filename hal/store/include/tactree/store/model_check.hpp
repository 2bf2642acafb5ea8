#pragma once
// Checks of a stored or announced model that do not depend on the flash driver. Not for use in a
// tick.

#include <cstddef>
#include <cstdint>
#include <span>

#include "tactree/core/link/wire/messages.hpp"
#include "tactree/core/model/blob.hpp"
#include "tactree/store/model_record.hpp"

namespace tactree::store {

struct StoreSetup {
  const char* board = "";                ///< name of this board
  const std::uint8_t* key = nullptr;     ///< 32 bytes; nullptr: no signature is required
  std::span<const std::byte> factory{};  ///< initial model, part of the image; may be empty
};

/// Checks an announced model before anything is erased. Errors: kTooLarge, kBadValue, kWrongBoard,
/// kOldCounter. `counter_min`: see ModelRecord. Cost: constant.
[[nodiscard]] core::wire::WireStatus check_announcement(
    const core::wire::BeginModelRequest& request, std::uint32_t slot_bytes,
    std::uint32_t counter_min, const StoreSetup& setup);

/// Checks the bytes of a slot against its entry, without the signature. Errors: kBadChecksum,
/// kWrongBoard, kOldCounter. Cost: checksum of all bytes.
[[nodiscard]] core::wire::WireStatus check_entry(const SlotEntry& entry,
                                                 std::span<const std::byte> bytes,
                                                 std::uint32_t counter_min,
                                                 const StoreSetup& setup);

/// True if the entry has a valid signature of these bytes by the owner of `key`. Cost: two passes
/// over all bytes.
[[nodiscard]] bool is_authentic(const SlotEntry& entry, std::span<const std::byte> bytes,
                                const std::uint8_t* key);

/// Returns true if the model in the image overlaps these bytes and is valid. Cost: validates the
/// model.
[[nodiscard]] bool holds_factory_model(std::span<const std::byte> slot, const StoreSetup& setup);

}  // namespace tactree::store
