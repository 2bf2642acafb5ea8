#pragma once
// Device firmware upgrade, version 1.1 (USB-IF, 2004), for one interface: the states of DFU mode.
// It transfers a model or parameters, not firmware. The device never leaves DFU mode, needs no
// detach and continues to work after a download (manifestation tolerant). The storage validates the
// data.
//
// Interrupt safety: no shared state; one context owns an object. Constant cost plus the storage's.

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>

#include "tactree/core/link/usb/descriptors.hpp"
#include "tactree/core/link/usb/setup.hpp"

namespace tactree::core::usb {

enum class DfuRequest : std::uint8_t {
  kDetach = 0,
  kDownload = 1,
  kUpload = 2,
  kAskStatus = 3,
  kClearStatus = 4,
  kAskState = 5,
  kAbort = 6,
};

enum class DfuState : std::uint8_t {
  kIdle = 2,
  kDownloadSync = 3,  ///< a block was received; its status is not yet requested
  kDownloadBusy = 4,  ///< the block is being written; the host waits
  kDownloadIdle = 5,  ///< ready for the next block
  kManifestSync = 6,  ///< all blocks were received
  kManifest = 7,      ///< the data is being validated; the host waits
  kUploadIdle = 9,
  kError = 10,
};

enum class DfuStatus : std::uint8_t {
  kOk = 0x00,
  kTarget = 0x01,    ///< not meant for this device
  kFile = 0x02,      ///< refused by a vendor-specific check
  kWrite = 0x03,     ///< the memory cannot be written
  kErase = 0x04,     ///< the memory cannot be erased
  kProgram = 0x06,   ///< programming failed
  kVerify = 0x07,    ///< the programmed bytes differ from those sent
  kAddress = 0x08,   ///< out of range, or a block out of order
  kNotDone = 0x09,   ///< the host ended too early
  kFirmware = 0x0A,  ///< the stored data is damaged
  kUnknown = 0x0E,
  kStalledPacket = 0x0F,  ///< a request not allowed in the present state
};

/// Progress of a storage's last operation.
struct DfuProgress {
  DfuStatus status = DfuStatus::kOk;
  bool busy = false;
  std::uint32_t wait_ms = 0;  ///< time until the next status request; below 2^24
};

/// Source and destination of the bytes. Functions return immediately; progress() reports whether an
/// operation is still running.
///   begin()                prepares to replace the stored data
///   write(offset, bytes)   offsets ascend without gaps
///   finish()               all bytes were written: validates and uses them
///   abort()                the host gave up or was unplugged; also called without begin()
///   read(offset, bytes, count)   reads the stored data; count < bytes.size() at the end
template <class T>
concept DfuStorage = requires(T& storage, std::uint32_t offset, std::span<const std::byte> from,
                              std::span<std::byte> to, std::size_t& count) {
  { storage.begin() } -> std::same_as<DfuStatus>;
  { storage.write(offset, from) } -> std::same_as<DfuStatus>;
  { storage.finish() } -> std::same_as<DfuStatus>;
  { storage.progress() } -> std::same_as<DfuProgress>;
  { storage.abort() } -> std::same_as<void>;
  { storage.read(offset, to, count) } -> std::same_as<DfuStatus>;
};

/// A storage that refuses every transfer.
struct NoDfuStorage {
  [[nodiscard]] static DfuStatus begin() { return DfuStatus::kTarget; }
  [[nodiscard]] static DfuStatus write(std::uint32_t, std::span<const std::byte>) {
    return DfuStatus::kTarget;
  }
  [[nodiscard]] static DfuStatus finish() { return DfuStatus::kTarget; }
  [[nodiscard]] static DfuProgress progress() { return {DfuStatus::kTarget}; }
  static void abort() {}
  [[nodiscard]] static DfuStatus read(std::uint32_t, std::span<std::byte>, std::size_t&) {
    return DfuStatus::kTarget;
  }
};
static_assert(DfuStorage<NoDfuStorage>);

template <DfuStorage Storage>
class Dfu {
 public:
  explicit Dfu(Storage& storage) : storage_(storage) {}

  /// Call after a bus reset or disconnect.
  void reset() {
    storage_.abort();
    state_ = DfuState::kIdle;
    status_ = DfuStatus::kOk;
  }

  /// Call once per tick. Ends the waiting time of the host.
  void advance(std::uint32_t now_us) {
    now_us_ = now_us;
    if (is_waiting() && now_us_ - waits_since_us_ >= wait_us_) {
      state_ = state_ == DfuState::kManifest ? DfuState::kManifestSync : DfuState::kDownloadSync;
    }
  }

  /// Handles a class request to this interface.
  [[nodiscard]] ControlResponse setup(const SetupPacket& setup) {
    const auto request = static_cast<DfuRequest>(setup.bRequest);
    // The standard allows no request while the host waits. Since the clocks differ, and the device
    // may read its own clock late, an early status request gets the waiting time again.
    if (request == DfuRequest::kAskStatus) {
      return is_query(setup, kStatusBytes) ? send_status(setup) : fail(DfuStatus::kStalledPacket);
    }
    if (request == DfuRequest::kAskState && !is_waiting()) {
      return is_query(setup, 1) ? send_state(setup) : fail(DfuStatus::kStalledPacket);
    }
    if (state_ == DfuState::kError) {
      return request == DfuRequest::kClearStatus && is_bare(setup) ? clear() : stall();
    }
    if (request == DfuRequest::kAbort && is_bare(setup) && may_abort()) {
      reset();
      return acknowledge();
    }
    if (request == DfuRequest::kDownload && !setup.to_host() && may_download()) {
      return setup.wLength == 0 ? end_download() : begin_block(setup);
    }
    if (request == DfuRequest::kUpload && setup.to_host() && may_upload()) {
      return upload(setup);
    }
    return fail(DfuStatus::kStalledPacket);
  }

  /// Handles the bytes of a block, after setup() returned kReceive.
  [[nodiscard]] ControlResponse data(std::span<const std::byte> bytes) {
    if (bytes.size() != block_bytes_) {
      return fail(DfuStatus::kStalledPacket);
    }
    const DfuStatus status = storage_.write(offset_, bytes);
    if (status != DfuStatus::kOk) {
      return fail(status);
    }
    offset_ += static_cast<std::uint32_t>(bytes.size());
    ++block_;
    state_ = DfuState::kDownloadSync;
    return acknowledge();
  }

  [[nodiscard]] DfuState state() const { return state_; }
  [[nodiscard]] DfuStatus status() const { return status_; }

 private:
  static constexpr std::uint16_t kStatusBytes = 6;

  [[nodiscard]] static bool is_bare(const SetupPacket& setup) {
    return !setup.to_host() && setup.wLength == 0 && setup.wValue == 0;
  }
  [[nodiscard]] static bool is_query(const SetupPacket& setup, std::uint16_t bytes) {
    return setup.to_host() && setup.wValue == 0 && setup.wLength == bytes;
  }
  [[nodiscard]] bool is_waiting() const {
    return state_ == DfuState::kDownloadBusy || state_ == DfuState::kManifest;
  }
  [[nodiscard]] bool may_abort() const {
    return state_ == DfuState::kIdle || state_ == DfuState::kDownloadIdle ||
           state_ == DfuState::kUploadIdle;
  }
  [[nodiscard]] bool may_download() const {
    return state_ == DfuState::kIdle || state_ == DfuState::kDownloadIdle;
  }
  [[nodiscard]] bool may_upload() const {
    return state_ == DfuState::kIdle || state_ == DfuState::kUploadIdle;
  }

  [[gnu::noinline]] ControlResponse fail(DfuStatus status) {
    storage_.abort();
    state_ = DfuState::kError;
    status_ = status;
    return stall();
  }

  ControlResponse clear() {
    state_ = DfuState::kIdle;
    status_ = DfuStatus::kOk;
    return acknowledge();
  }

  [[nodiscard]] ControlResponse begin_block(const SetupPacket& setup) {
    if (setup.wLength > kDfuTransferBytes) {
      return fail(DfuStatus::kStalledPacket);
    }
    if (state_ == DfuState::kIdle) {
      offset_ = 0;
      block_ = setup.wValue;  // tools begin with 0 or with 1
      const DfuStatus status = storage_.begin();
      if (status != DfuStatus::kOk) {
        return fail(status);
      }
    }
    if (setup.wValue != block_) {
      return fail(DfuStatus::kAddress);
    }
    block_bytes_ = setup.wLength;
    return receive();
  }

  /// The block number is ignored.
  [[nodiscard]] ControlResponse end_download() {
    if (state_ != DfuState::kDownloadIdle) {
      return fail(DfuStatus::kStalledPacket);
    }
    const DfuStatus status = storage_.finish();
    if (status != DfuStatus::kOk) {
      return fail(status);
    }
    state_ = DfuState::kManifestSync;
    return acknowledge();
  }

  [[nodiscard]] ControlResponse upload(const SetupPacket& setup) {
    if (setup.wLength == 0 || setup.wLength > kDfuTransferBytes) {
      return fail(DfuStatus::kStalledPacket);
    }
    if (state_ == DfuState::kIdle) {
      offset_ = 0;
      block_ = setup.wValue;
    }
    if (setup.wValue != block_) {
      return fail(DfuStatus::kAddress);
    }
    std::size_t count = 0;
    const auto to = std::span(buffer_).first(setup.wLength);
    const DfuStatus status = storage_.read(offset_, to, count);
    if (status != DfuStatus::kOk || count > to.size()) {
      return fail(status == DfuStatus::kOk ? DfuStatus::kUnknown : status);
    }
    offset_ += static_cast<std::uint32_t>(count);
    ++block_;
    // A short block, even the first one, ends the upload: the host sends no further request.
    state_ = count < to.size() ? DfuState::kIdle : DfuState::kUploadIdle;
    return send(to.first(count), setup);
  }

  /// A status request advances the transfer.
  void proceed() {
    const bool manifest = state_ == DfuState::kManifestSync;
    if (!manifest && state_ != DfuState::kDownloadSync) {
      return;
    }
    const DfuProgress progress = storage_.progress();
    if (progress.status != DfuStatus::kOk) {
      (void)fail(progress.status);
    } else if (progress.busy) {
      state_ = manifest ? DfuState::kManifest : DfuState::kDownloadBusy;
      wait_ms_ = progress.wait_ms;
      wait_us_ = 1000U * wait_ms_;
      waits_since_us_ = now_us_;
    } else {
      state_ = manifest ? DfuState::kIdle : DfuState::kDownloadIdle;
    }
  }

  [[nodiscard]] ControlResponse send_status(const SetupPacket& setup) {
    if (!is_waiting()) {
      wait_ms_ = 0;
      proceed();
    }
    buffer_[0] = static_cast<std::byte>(status_);
    buffer_[1] = static_cast<std::byte>(wait_ms_ & 0xFFU);
    buffer_[2] = static_cast<std::byte>((wait_ms_ >> 8U) & 0xFFU);
    buffer_[3] = static_cast<std::byte>((wait_ms_ >> 16U) & 0xFFU);
    buffer_[4] = static_cast<std::byte>(state_);
    buffer_[5] = std::byte{0};  // no string
    return send(std::span(buffer_).first(kStatusBytes), setup);
  }

  [[nodiscard]] ControlResponse send_state(const SetupPacket& setup) {
    buffer_[0] = static_cast<std::byte>(state_);
    return send(std::span(buffer_).first(1), setup);
  }

  Storage& storage_;
  DfuState state_ = DfuState::kIdle;
  DfuStatus status_ = DfuStatus::kOk;
  std::uint16_t block_ = 0;  // number of the next block
  std::uint16_t block_bytes_ = 0;
  std::uint32_t offset_ = 0;
  std::uint32_t wait_ms_ = 0;
  std::uint32_t wait_us_ = 0;
  std::uint32_t waits_since_us_ = 0;
  std::uint32_t now_us_ = 0;
  alignas(4) std::byte buffer_[kDfuTransferBytes] = {};
};

}  // namespace tactree::core::usb
