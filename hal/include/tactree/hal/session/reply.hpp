#pragma once
// The answer to one request, while it is being put together.

#include <cstddef>
#include <cstdint>
#include <span>

#include "tactree/core/wire/messages.hpp"

namespace tactree::hal {

class Reply {
 public:
  void clear() {
    size_ = 0;
    status_ = core::wire::WireStatus::kOk;
  }
  void refuse(core::wire::WireStatus status) { status_ = status; }

  template <core::wire::Message T>
  void put(const T& message) {
    append(std::as_bytes(std::span(&message, 1)));
  }
  /// What has no room is left out: the messages' sizes are checked where they are declared.
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

}  // namespace tactree::hal
