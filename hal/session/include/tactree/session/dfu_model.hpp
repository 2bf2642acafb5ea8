#pragma once
// Model download and upload over DFU: the blocks of a blob are written to the store's spare slot;
// the model is used once it is complete and the controller accepts it. A DFU file contains neither
// board name nor signature, so a board that requires signatures refuses the download. A board whose
// link may only watch (LinkSupervision::may_command) refuses it, too; an upload changes nothing.
//
// The first block contains the blob's header, which gives the length to erase. progress() erases
// and programs in bounded steps while the host polls. Not for use in a tick; call from one context.

#include <cstddef>
#include <cstdint>
#include <span>

#include "tactree/core/control/between_ticks.hpp"
#include "tactree/core/control/controller.hpp"
#include "tactree/core/link/usb/dfu.hpp"
#include "tactree/core/link/wire/messages.hpp"
#include "tactree/core/math/crc32.hpp"
#include "tactree/core/model/blob_format.hpp"
#include "tactree/session/tick_mailbox.hpp"

namespace tactree::session {

/// Store: a ModelStore. Platform: see BetweenTicks.
template <class Store, class Platform>
class DfuModel {
 public:
  using DfuStatus = core::usb::DfuStatus;
  using WireStatus = core::wire::WireStatus;

  DfuModel(Store& store, core::Controller& controller, TickMailbox& mailbox, Platform& platform)
      : store_(store), changes_(controller, platform), mailbox_(mailbox) {}

  [[nodiscard]] DfuStatus begin() {
    abort();
    if (!may_change() || store_.signature_required()) {
      return DfuStatus::kTarget;
    }
    begun_ = true;
    return DfuStatus::kOk;
  }

  /// Accepts a block, which progress() then writes.
  [[nodiscard]] DfuStatus write(std::uint32_t offset, std::span<const std::byte> bytes) {
    if (!begun_ || programmed_ != waiting_ || bytes.size() > sizeof block_) {
      return DfuStatus::kAddress;
    }
    if (!may_change()) {
      return DfuStatus::kTarget;
    }
    if (offset == 0U) {
      const DfuStatus status = announce(bytes);
      if (status != DfuStatus::kOk) {
        return status;
      }
    }
    if (offset > total_ || bytes.size() > total_ - offset) {
      return DfuStatus::kAddress;  // beyond the length in the header
    }
    __builtin_memcpy(block_, bytes.data(), bytes.size());
    offset_ = offset;
    waiting_ = bytes.size();
    programmed_ = 0;
    crc_.update(bytes);
    return DfuStatus::kOk;
  }

  /// Erases one sector or programs one piece.
  [[nodiscard]] core::usb::DfuProgress progress() {
    if (!begun_ || (!store_.is_erasing() && programmed_ == waiting_)) {
      return {};
    }
    mailbox_.set_storage_busy(true);
    const WireStatus status = store_.is_erasing() ? store_.erase_next() : program_piece();
    const bool busy = store_.is_erasing() || programmed_ != waiting_;
    mailbox_.set_storage_busy(busy);
    if (status != WireStatus::kOk) {
      abort();
      return {to_dfu(status), false, 0};
    }
    return {DfuStatus::kOk, busy, busy ? kWaitMs : 0};
  }

  [[nodiscard]] DfuStatus finish() {
    if (!begun_ || offset_ + waiting_ != total_ || programmed_ != waiting_) {
      return DfuStatus::kNotDone;
    }
    begun_ = false;
    const std::uint32_t slot = store_.transfer_slot();
    store_.announce_checksum(crc_.value(), this);
    core::BlobStatus blob = core::BlobStatus::kOk;
    const WireStatus status = store_.finish({}, blob, this);
    return status == WireStatus::kOk ? use(slot) : to_dfu(status);
  }

  void abort() {
    if (begun_) {
      mailbox_.set_storage_busy(false);
    }
    begun_ = false;
    offset_ = total_ = 0;
    waiting_ = programmed_ = 0;
    crc_ = {};
    store_.release(this);
  }

  [[nodiscard]] DfuStatus read(std::uint32_t offset, std::span<std::byte> bytes,
                               std::size_t& count) {
    if (offset == 0U) {
      model_ = store_.active();
      other_slot_ = store_.other_slot();
    }
    if (store_.other_slot() != other_slot_) {
      return DfuStatus::kFirmware;  // another model was activated since the upload began
    }
    const std::size_t left = offset < model_.size() ? model_.size() - offset : 0;
    count = bytes.size() < left ? bytes.size() : left;
    if (count != 0U) {
      __builtin_memcpy(bytes.data(), model_.data() + offset, count);
    }
    return DfuStatus::kOk;
  }

 private:
  /// Wait of the host before its next status request, which continues the work: the shortest that
  /// DFU can express.
  static constexpr std::uint32_t kWaitMs = 1;

  [[nodiscard]] bool may_change() const {
    const core::Controller& controller = changes_.controller();
    return controller.motors_off() && controller.configuration().link.may_command;
  }

  [[nodiscard]] DfuStatus announce(std::span<const std::byte> bytes) {
    core::BlobHeader header;
    if (bytes.size() < sizeof header) {
      return DfuStatus::kFile;
    }
    __builtin_memcpy(&header, bytes.data(), sizeof header);
    total_ = header.total_bytes;
    core::wire::BeginModelRequest request;
    request.bytes = total_;
    return to_dfu(store_.begin(request, this));
  }

  [[nodiscard]] WireStatus program_piece() {
    const std::size_t left = waiting_ - programmed_;
    const std::size_t size = left < core::wire::kMaxPiece ? left : core::wire::kMaxPiece;
    const auto piece = std::span<const std::byte>(block_).subspan(programmed_, size);
    const auto offset = static_cast<std::uint32_t>(offset_ + programmed_);
    const WireStatus status = store_.write(offset, piece, this);
    programmed_ += size;
    return status;
  }

  /// The controller loads the model first, so a model that it refuses is not recorded.
  [[nodiscard]] DfuStatus use(std::uint32_t slot) {
    core::BlobView view;
    core::BlobStatus blob = core::BlobStatus::kOk;
    const WireStatus status = store_.open(slot, view, blob);
    if (status != WireStatus::kOk) {
      return to_dfu(status);
    }
    const core::ModelStatus model = changes_.load_model(view);
    return model == core::ModelStatus::kOk ? to_dfu(store_.activate(slot)) : DfuStatus::kTarget;
  }

  [[nodiscard]] static DfuStatus to_dfu(WireStatus status) {
    switch (status) {
      case WireStatus::kOk:
        return DfuStatus::kOk;
      case WireStatus::kTooLarge:
      case WireStatus::kOutOfOrder:
        return DfuStatus::kAddress;
      case WireStatus::kStorageFailed:
        return DfuStatus::kProgram;
      case WireStatus::kBadChecksum:
        return DfuStatus::kVerify;
      case WireStatus::kBadValue:
      case WireStatus::kBadModel:
      case WireStatus::kNoModel:
        return DfuStatus::kFile;
      case WireStatus::kInterrupted:
      case WireStatus::kNoTransfer:
        return DfuStatus::kNotDone;
      default:
        return DfuStatus::kTarget;
    }
  }

  Store& store_;
  core::BetweenTicks<Platform> changes_;
  TickMailbox& mailbox_;

  bool begun_ = false;
  std::uint32_t total_ = 0;     // bytes of the model, from its header
  std::uint32_t offset_ = 0;    // of the block
  std::size_t waiting_ = 0;     // bytes in the block
  std::size_t programmed_ = 0;  // bytes of the block that are programmed
  core::Crc32 crc_{};
  alignas(4) std::byte block_[core::usb::kDfuTransferBytes] = {};
  std::span<const std::byte> model_{};  // being uploaded
  std::uint32_t other_slot_ = 0;
};

}  // namespace tactree::session
