#pragma once
// Two model slots in a board's flash, and a log of records that states which slot is in use. A new
// model is written to the other slot, checked there, and used once a record that refers to it is
// complete: after a power cut at any time, either the old or the new model is in use.
//
//   sector 0, 1   records            record_log.hpp
//   then          slot 0, slot 1     half of the other sectors each
//
// In a flash with sectors of several sizes, the small sectors hold the records, as a separate
// Flash.
//
// The model in the image may overlap the slots. While it is in use, a slot that it overlaps is not
// written.
//
// Flash content is never trusted: before each use the model's checksum, signature (if a key is set)
// and blob are checked. A store that was written but has no valid record is damaged: it has no
// model until one is written.
//
// A board with a key accepts only signed models, and none whose counter is smaller than that of a
// model used before.
//
// Not for use in a tick. Call from one context.
// Loop and memory annotations: docs/BOUND.md.

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>

#include "tactree/core/link/wire/messages.hpp"
#include "tactree/core/model/blob.hpp"
#include "tactree/store/model_check.hpp"
#include "tactree/store/record_log.hpp"

namespace tactree::store {

/// `kVerifies`: contains the code that verifies signatures, 4.5 KiB on a Cortex-M. A store without
/// it refuses every model if StoreSetup has a key.
template <hal::Flash F, hal::Flash Records = F, bool kVerifies = true>
class ModelStore {
 public:
  using WireStatus = core::wire::WireStatus;
  static constexpr std::uint32_t kSlots = kStoreSlots;

  ModelStore(F& flash, const StoreSetup& setup) requires std::same_as<F, Records>
      : flash_(flash), first_slot_sector_(2), setup_(setup), log_(flash) {}

  /// Uses two sectors of `records` for the log, and all of `flash` for the slots.
  ModelStore(F& flash, Records& records, const StoreSetup& setup)
      : flash_(flash), first_slot_sector_(0), setup_(setup), log_(records) {}

  // ---- at start-up

  /// Replaces StoreSetup::factory. Call before mount().
  void set_factory(std::span<const std::byte> model) { setup_.factory = model; }

  /// Reads the record. Call before the functions below. Returns false if the store is damaged; it
  /// then has no model.
  bool mount() {
    record_ = {};
    const auto found = log_.find(slot_bytes(), record_);
    damaged_ = found == RecordLog<Records>::Found::kDamaged;
    if (found != RecordLog<Records>::Found::kRecord) {
      record_ = {};
    }
    return !damaged_;
  }

  /// Returns the model in use, as in BlobStorage; empty if there is none that can be used.
  [[nodiscard]] std::span<const std::byte> active() const noexcept {
    if (damaged_) {
      return {};
    }
    if (record_.active == kFactorySlot) {
      return setup_.factory;
    }
    core::BlobView view;
    core::BlobStatus blob = core::BlobStatus::kOk;
    const bool good = check_slot(record_.active, view, blob) == WireStatus::kOk;
    return good ? bytes_of(record_.active, record_.slot[record_.active].bytes)
                : std::span<const std::byte>();
  }

  /// Returns kParameters values, or nullptr if none were saved.
  [[nodiscard]] const float* parameters() const {
    return record_.has_parameters != 0U ? record_.parameter : nullptr;
  }

  // ---- for ModelTransfer and DfuModel; `owner` identifies the writer

  [[nodiscard]] std::uint32_t slot_bytes() const {
    return sectors_per_slot() * flash_.geometry().sector_bytes;
  }
  [[nodiscard]] bool signature_required() const { return setup_.key != nullptr; }

  [[nodiscard]] core::wire::ListModelsReply list() const {
    core::wire::ListModelsReply reply;
    reply.counter_min = record_.counter_min;
    reply.slots = kSlots;
    for (std::uint32_t i = 0; i < kSlots; ++i) {  // bound: kSlots
      reply.slot[i] = describe_slot(i);
    }
    return reply;
  }

  [[nodiscard]] WireStatus begin(const core::wire::BeginModelRequest& request, const void* owner) {
    if (owner_ != nullptr && owner_ != owner) {
      return WireStatus::kOtherWriter;
    }
    const WireStatus status =
        check_announcement(request, slot_bytes(), record_.counter_min, setup_);
    if (status != WireStatus::kOk) {
      return status;
    }
    const std::uint32_t spare = spare_slot();
    if (holds_factory(spare)) {
      return WireStatus::kInUse;
    }
    owner_ = owner;
    announced_ = request;
    next_offset_ = 0;
    slot_ = spare;
    record_.slot[slot_] = {};
    return start_erasing(announced_.bytes);
  }

  /// Erases the next sector. Call while is_erasing().
  [[nodiscard]] WireStatus erase_next() {
    if (!is_erasing()) {
      return WireStatus::kOk;
    }
    const std::uint32_t sector = next_sector_;
    ++next_sector_;
    if (flash_.erase(sector)) {
      return WireStatus::kOk;
    }
    next_sector_ = end_sector_;
    owner_ = nullptr;
    return WireStatus::kStorageFailed;
  }
  [[nodiscard]] bool is_erasing() const { return next_sector_ != end_sector_; }
  [[nodiscard]] std::uint32_t transfer_slot() const { return slot_; }
  [[nodiscard]] std::uint32_t next_offset() const { return next_offset_; }

  [[nodiscard]] WireStatus write(std::uint32_t offset, std::span<const std::byte> bytes,
                                 const void* owner) {
    if (owner_ == nullptr || owner_ != owner) {
      return owner_ == nullptr ? WireStatus::kNoTransfer : WireStatus::kOtherWriter;
    }
    const bool last = next_offset_ + bytes.size() == announced_.bytes;
    const bool fits = offset == next_offset_ && !bytes.empty() &&
                      bytes.size() <= announced_.bytes - next_offset_ &&
                      bytes.size() <= core::wire::kMaxPiece;
    if (!fits || (bytes.size() % kMaxProgramBytes != 0U && !last)) {
      return WireStatus::kOutOfOrder;
    }
    if (!program(bytes)) {
      owner_ = nullptr;
      return WireStatus::kStorageFailed;
    }
    next_offset_ += static_cast<std::uint32_t>(bytes.size());
    return WireStatus::kOk;
  }

  /// Sets the checksum of a transfer that was not known in begin().
  void announce_checksum(std::uint32_t checksum, const void* owner) {
    if (owner_ != nullptr && owner_ == owner) {
      announced_.checksum = checksum;
    }
  }

  /// Checks the written bytes against the announcement (check_model()) and commits the slot.
  [[nodiscard]] WireStatus finish(const core::wire::FinishModelRequest& request,
                                  core::BlobStatus& blob, const void* owner) {
    if (owner_ == nullptr || owner_ != owner) {
      return owner_ == nullptr ? WireStatus::kNoTransfer : WireStatus::kOtherWriter;
    }
    owner_ = nullptr;
    if (next_offset_ != announced_.bytes) {
      return WireStatus::kInterrupted;
    }
    SlotEntry entry;
    __builtin_memcpy(entry.board, announced_.board, sizeof entry.board);
    entry.bytes = announced_.bytes;
    entry.checksum = announced_.checksum;
    entry.counter = announced_.counter;
    entry.is_signed = request.is_signed != 0U ? 1U : 0U;
    __builtin_memcpy(entry.signature, request.signature, sizeof entry.signature);
    core::BlobView view;
    const WireStatus status = check(entry, slot_, view, blob);
    return status == WireStatus::kOk ? commit_slot(slot_, entry) : status;
  }

  /// Aborts the transfer of this owner, if there is one.
  void release(const void* owner) {
    if (owner_ == owner) {
      owner_ = nullptr;
    }
  }

  /// Opens the model of a slot, if it can be used.
  [[nodiscard]] WireStatus open(std::uint32_t slot, core::BlobView& view,
                                core::BlobStatus& blob) const {
    if (slot >= kSlots || record_.slot[slot].bytes == 0U) {
      return WireStatus::kNoModel;
    }
    return check_slot(slot, view, blob);
  }

  /// Precondition: open(slot) returned kOk.
  [[nodiscard]] WireStatus activate(std::uint32_t slot) {
    ModelRecord changed = record_;
    changed.active = slot;
    const std::uint32_t counter = changed.slot[slot].counter;
    if (changed.slot[slot].is_signed != 0U && counter > changed.counter_min) {
      changed.counter_min = counter;
    }
    const WireStatus status = commit(changed);
    damaged_ = damaged_ && status != WireStatus::kOk;
    return status;
  }

  /// Returns the slot that is not in use, or kSlots if the model in the image is in use.
  [[nodiscard]] std::uint32_t other_slot() const {
    return record_.active < kSlots ? 1U - record_.active : kSlots;
  }

  [[nodiscard]] WireStatus begin_erase(std::uint32_t slot, const void* owner) {
    if (slot >= kSlots) {
      return WireStatus::kBadValue;
    }
    if (slot == record_.active || holds_factory(slot)) {
      return WireStatus::kInUse;
    }
    if (owner_ != nullptr && owner_ != owner) {
      return WireStatus::kOtherWriter;
    }
    owner_ = nullptr;
    const WireStatus status = commit_slot(slot, {});
    if (status != WireStatus::kOk) {
      return status;
    }
    slot_ = slot;
    return start_erasing(slot_bytes());
  }

  [[nodiscard]] WireStatus save_parameters(const float (&values)[core::kParameters]) {
    ModelRecord changed = record_;
    changed.has_parameters = 1;
    __builtin_memcpy(changed.parameter, values, sizeof values);
    return commit(changed);
  }

 private:
  static constexpr std::uint32_t kMaxProgramBytes = 32;  // maximum of FlashGeometry::program_bytes

  [[nodiscard]] std::uint32_t sectors_per_slot() const {
    return (flash_.geometry().sectors - first_slot_sector_) / kSlots;
  }
  [[nodiscard]] std::uint32_t first_sector(std::uint32_t slot) const {
    return first_slot_sector_ + slot * sectors_per_slot();
  }
  [[nodiscard]] std::span<const std::byte> bytes_of(std::uint32_t slot, std::uint32_t count) const {
    return flash_.bytes().subspan(first_sector(slot) * flash_.geometry().sector_bytes, count);
  }

  [[nodiscard]] std::uint32_t spare_slot() const {
    if (record_.active < kSlots) {
      return 1U - record_.active;
    }
    return record_.slot[0].bytes == 0U && !holds_factory(0) ? 0U : 1U;
  }

  /// Returns true if the model in the image is in use and overlaps the slot. Cost: validates the
  /// model.
  [[nodiscard]] bool holds_factory(std::uint32_t slot) const {
    return record_.active == kFactorySlot &&
           holds_factory_model(bytes_of(slot, slot_bytes()), setup_);
  }

  [[nodiscard]] WireStatus start_erasing(std::uint32_t bytes) {
    const std::uint32_t sector_bytes = flash_.geometry().sector_bytes;
    next_sector_ = first_sector(slot_);
    end_sector_ = next_sector_ + (bytes + sector_bytes - 1U) / sector_bytes;
    return WireStatus::kOk;
  }

  // The last piece is padded with 0xFF, the value of erased flash.
  [[nodiscard]] bool program(std::span<const std::byte> bytes) {
    alignas(4) std::byte piece[core::wire::kMaxPiece];
    for (std::byte& byte : piece) {  // bound: kMaxPiece
      byte = std::byte{0xFF};
    }
    __builtin_memcpy(piece, bytes.data(), bytes.size());
    const std::uint32_t unit = flash_.geometry().program_bytes;
    const std::size_t size = (bytes.size() + unit - 1U) / unit * unit;
    const std::uint32_t offset =
        first_sector(slot_) * flash_.geometry().sector_bytes + next_offset_;
    return flash_.program(offset, std::span(piece).first(size)) &&
           __builtin_memcmp(flash_.bytes().data() + offset, piece, size) == 0;
  }

  [[nodiscard]] WireStatus commit(ModelRecord& changed) {
    if (!log_.append(changed)) {
      return WireStatus::kStorageFailed;
    }
    record_ = changed;
    return WireStatus::kOk;
  }

  /// Not inlined, because the large record would otherwise be on the stack during check().
  [[gnu::noinline, nodiscard]] WireStatus commit_slot(std::uint32_t slot, const SlotEntry& entry) {
    ModelRecord changed = record_;
    changed.slot[slot] = entry;
    return commit(changed);
  }

  [[nodiscard]] WireStatus check_slot(std::uint32_t slot, core::BlobView& view,
                                      core::BlobStatus& blob) const {
    return check(record_.slot[slot], slot, view, blob);
  }

  [[nodiscard]] WireStatus check(const SlotEntry& entry, std::uint32_t slot, core::BlobView& view,
                                 core::BlobStatus& blob) const {
    const std::span<const std::byte> bytes = bytes_of(slot, entry.bytes);
    const WireStatus status = check_entry(entry, bytes, record_.counter_min, setup_);
    if (status != WireStatus::kOk) {
      return status;
    }
    bool authentic = setup_.key == nullptr;
    if constexpr (kVerifies) {
      authentic = authentic || is_authentic(entry, bytes, setup_.key);
    }
    if (!authentic) {
      return WireStatus::kBadSignature;
    }
    blob = core::open_blob(bytes, view);
    return blob == core::BlobStatus::kOk ? WireStatus::kOk : WireStatus::kBadModel;
  }

  [[nodiscard]] core::wire::ModelSlot describe_slot(std::uint32_t slot) const {
    using core::wire::SlotState;
    const SlotEntry& entry = record_.slot[slot];
    core::wire::ModelSlot described;
    described.bytes = entry.bytes;
    described.checksum = entry.checksum;
    described.counter = entry.counter;
    described.flags = entry.is_signed != 0U ? 1U : 0U;
    SlotState state = SlotState::kEmpty;
    if (owner_ != nullptr && slot == slot_) {
      state = SlotState::kPartial;
    } else if (entry.bytes != 0U) {
      core::BlobView view;
      core::BlobStatus blob = core::BlobStatus::kOk;
      const bool good = check_slot(slot, view, blob) == WireStatus::kOk;
      described.blob = static_cast<std::uint8_t>(blob);
      described.points = good ? view.point_count() : 0U;
      state = !good                    ? SlotState::kDamaged
              : slot == record_.active ? SlotState::kActive
                                       : SlotState::kReady;
    }
    described.state = static_cast<std::uint8_t>(state);
    return described;
  }

  F& flash_;
  std::uint32_t first_slot_sector_;
  StoreSetup setup_;
  RecordLog<Records> log_;
  ModelRecord record_{};
  bool damaged_ = false;

  const void* owner_ = nullptr;  // of the transfer; nullptr: no transfer
  core::wire::BeginModelRequest announced_{};
  std::uint32_t slot_ = 0;
  std::uint32_t next_offset_ = 0;
  std::uint32_t next_sector_ = 0;
  std::uint32_t end_sector_ = 0;
};

}  // namespace tactree::store
