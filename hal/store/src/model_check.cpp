// Loop and memory annotations: docs/BOUND.md.

#include "tactree/store/model_check.hpp"

#include "tactree/core/crypto/signature.hpp"
#include "tactree/core/math/crc32.hpp"
#include "tactree/core/model/blob_format.hpp"

namespace tactree::store {

using core::wire::WireStatus;

namespace {

/// An empty name matches any board.
bool is_for_board(const char (&name)[24], const char* board) {
  if (name[0] == '\0') {
    return true;
  }
  for (std::uint32_t i = 0; i < sizeof name; ++i) {  // bound: 24
    if (name[i] != board[i]) {
      return false;
    }
    if (name[i] == '\0') {
      return true;
    }
  }
  return false;
}

}  // namespace

bool is_authentic(const SlotEntry& entry, std::span<const std::byte> bytes,
                  const std::uint8_t* key) {
  core::wire::ModelManifest manifest;
  __builtin_memcpy(manifest.board, entry.board, sizeof manifest.board);
  manifest.counter = entry.counter;
  manifest.bytes = entry.bytes;
  return entry.is_signed != 0U &&
         core::is_signed_by(core::PublicKeyView(key, core::kPublicKeyBytes),
                            core::SignatureView(entry.signature),
                            std::as_bytes(std::span(&manifest, 1)), bytes);
}

WireStatus check_announcement(const core::wire::BeginModelRequest& request,
                              std::uint32_t slot_bytes, std::uint32_t counter_min,
                              const StoreSetup& setup) {
  if (request.bytes > slot_bytes) {
    return WireStatus::kTooLarge;
  }
  if (request.bytes < sizeof(core::BlobHeader)) {
    return WireStatus::kBadValue;
  }
  if (!is_for_board(request.board, setup.board)) {
    return WireStatus::kWrongBoard;
  }
  const bool old = setup.key != nullptr && request.counter < counter_min;
  return old ? WireStatus::kOldCounter : WireStatus::kOk;
}

WireStatus check_entry(const SlotEntry& entry, std::span<const std::byte> bytes,
                       std::uint32_t counter_min, const StoreSetup& setup) {
  if (core::crc32(bytes) != entry.checksum) {
    return WireStatus::kBadChecksum;
  }
  if (!is_for_board(entry.board, setup.board)) {
    return WireStatus::kWrongBoard;
  }
  const bool old = setup.key != nullptr && entry.counter < counter_min;
  return old ? WireStatus::kOldCounter : WireStatus::kOk;
}

bool holds_factory_model(std::span<const std::byte> slot, const StoreSetup& setup) {
  const auto address = [](const std::byte* byte) { return reinterpret_cast<std::uintptr_t>(byte); };
  const std::span<const std::byte> model = setup.factory;
  core::BlobView view;
  return address(model.data()) < address(slot.data() + slot.size()) &&
         address(slot.data()) < address(model.data() + model.size()) &&
         core::open_blob(model, view) == core::BlobStatus::kOk;
}

}  // namespace tactree::store
