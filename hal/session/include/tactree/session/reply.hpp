#pragma once
// The reply to one request while it is being composed: a status and a payload.

#include <cstddef>
#include <cstdint>
#include <span>

#include "tactree/core/link/wire/messages.hpp"

namespace tactree::session {

/// Action of the session after a handler has returned.
enum class Outcome : std::uint8_t {
  kAnswer,  ///< send the reply
  kSilent,  ///< send nothing
  kLater,   ///< not finished: call the handler again
};

class Reply {
 public:
  void clear() {
    size_ = 0;
    status_ = core::wire::WireStatus::kOk;
  }
  void set_status(core::wire::WireStatus status) { status_ = status; }

  template <core::wire::Message T>
  void put(const T& message) {
    append(std::as_bytes(std::span(&message, 1)));
  }
  /// Drops `bytes` if they do not fit. This cannot happen, because message sizes are checked at
  /// compile time.
  void append(std::span<const std::byte> bytes) {
    if (bytes.size() <= core::wire::kMaxPayload - size_) {
      __builtin_memcpy(bytes_ + size_, bytes.data(), bytes.size());
      size_ += bytes.size();
    }
  }

  [[nodiscard]] core::wire::WireStatus status() const { return status_; }
  [[nodiscard]] std::span<const std::byte> payload() const {
    return std::span(bytes_).first(size_);
  }

 private:
  alignas(4) std::byte bytes_[core::wire::kMaxPayload] = {};
  std::size_t size_ = 0;
  core::wire::WireStatus status_ = core::wire::WireStatus::kOk;
};

}  // namespace tactree::session
