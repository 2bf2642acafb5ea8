#pragma once
// Frames that wait for a port to take them.

#include <cstddef>
#include <cstdint>
#include <span>

#include "tactree/core/wire/frame.hpp"
#include "tactree/hal/board.hpp"

namespace tactree::hal {

/// Room for kFrames of the longest ones, and for as many more short ones as fit.
class FrameQueue {
 public:
  static constexpr std::size_t kFrames = 4;
  static constexpr std::size_t kBytes = kFrames * core::wire::kMaxEncodedFrame;

  /// Is there room for that many of the longest frames?
  [[nodiscard]] bool has_room(std::size_t frames) const {
    return kBytes - end_ >= frames * core::wire::kMaxEncodedFrame;
  }

  /// False: there was no room.
  bool push(const core::wire::FrameHeader& header, std::span<const std::byte> payload) {
    const std::size_t size =
        core::wire::encode_frame(header, payload, std::span(bytes_).subspan(end_));
    end_ += size;
    return size > 0U;
  }

  /// Hands over what the port takes. Cost: moves what is left, at most kBytes.
  template <BytePort Port>
  void flush(Port& port) {
    if (end_ == 0U) {
      return;
    }
    const std::size_t taken = port.write(std::span<const std::byte>(bytes_).first(end_));
    end_ -= taken;
    __builtin_memmove(bytes_, bytes_ + taken, end_);
  }

  void clear() { end_ = 0; }

 private:
  std::byte bytes_[kBytes] = {};
  std::size_t end_ = 0;
};

}  // namespace tactree::hal
