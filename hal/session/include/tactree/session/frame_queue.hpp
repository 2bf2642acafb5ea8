#pragma once
// Queue of encoded frames that wait for the port. Not interrupt safe: called between ticks only.

#include <cstddef>
#include <span>

#include "tactree/core/link/wire/frame.hpp"
#include "tactree/hal/board.hpp"

namespace tactree::session {

/// Holds kFrames frames of maximum length, or more shorter ones.
class FrameQueue {
 public:
  /// At least 2: telemetry leaves room for a reply. Four frames take 1.1 KB of RAM.
  static constexpr std::size_t kFrames = 4;
  static constexpr std::size_t kBytes = kFrames * core::wire::kMaxEncodedFrame;

  /// Returns true if this number of frames of maximum length fits.
  [[nodiscard]] bool has_room(std::size_t frames) const {
    return kBytes - end_ >= frames * core::wire::kMaxEncodedFrame;
  }

  /// Returns false if the frame does not fit.
  bool push(const core::wire::FrameHeader& header, std::span<const std::byte> payload) {
    const std::size_t size =
        core::wire::encode_frame(header, payload, std::span(bytes_).subspan(end_));
    end_ += size;
    return size > 0U;
  }

  /// Writes as many bytes as the port accepts. Cost: moves the remaining bytes, at most kBytes.
  template <hal::BytePort Port>
  void flush(Port& port) {
    if (end_ == 0U) {
      return;
    }
    const std::size_t taken = port.write(std::span<const std::byte>(bytes_).first(end_));
    end_ -= taken;
    __builtin_memmove(bytes_, bytes_ + taken, end_);
  }

 private:
  std::byte bytes_[kBytes] = {};
  std::size_t end_ = 0;
};

}  // namespace tactree::session
