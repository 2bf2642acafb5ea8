#pragma once
// A message on the wire: header, payload, CRC-32; COBS-encoded and ended by a zero byte, so that a
// reader that joins late, or has lost bytes, finds the next message at the next zero. The same on a
// stream of bytes (serial port, pseudo-terminal) and in USB packets, which may cut a frame
// anywhere. (S. Cheshire, M. Baker, "Consistent Overhead Byte Stuffing", IEEE/ACM ToN 7(2), 1999.)
//
// Interrupt safe: no shared state. Every byte is told in docs/PROTOCOL.md.

#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>

#include "tactree/core/crc32.hpp"

namespace tactree::core::wire {

struct FrameHeader {
  std::uint8_t kind = 0;    ///< MessageKind; of a reply: with kReplyBit
  std::uint8_t status = 0;  ///< WireStatus, of a reply; else 0
  std::uint16_t sequence = 0;
  std::uint16_t session = 0;  ///< as the board gave it out; 0: of none
  std::uint16_t payload_bytes = 0;
};
static_assert(sizeof(FrameHeader) == 8 && alignof(FrameHeader) == 2);

inline constexpr std::uint32_t kMaxPayload = 264;
inline constexpr std::uint32_t kFrameChecksumBytes = 4;
/// Header, payload and checksum, before COBS.
inline constexpr std::uint32_t kMaxFrame = 276;
static_assert(kMaxFrame == sizeof(FrameHeader) + kMaxPayload + kFrameChecksumBytes);
/// COBS adds a byte for each 254 begun, and the zero at the end.
inline constexpr std::uint32_t kMaxEncodedFrame = 279;
static_assert(kMaxEncodedFrame == kMaxFrame + (kMaxFrame + 253U) / 254U + 1U);
/// Between two frames.
inline constexpr std::uint8_t kDelimiter = 0;

/// Writes a frame to `out` and returns its length, the delimiter included. 0: the payload is longer
/// than kMaxPayload, or `out` is shorter than kMaxEncodedFrame. `header.payload_bytes` is filled in
/// here. Cost: about 25 instructions a byte.
[[nodiscard]] std::size_t encode_frame(FrameHeader header, std::span<const std::byte> payload,
                                       std::span<std::byte> out);

/// A message whose fields lie in memory as on the wire.
template <class T>
concept Message = std::is_aggregate_v<T> && std::is_trivially_copyable_v<T> &&
                  sizeof(T) <= kMaxPayload;

template <Message T>
[[nodiscard]] std::size_t encode_message(const FrameHeader& header, const T& message,
                                         std::span<std::byte> out) {
  return encode_frame(header, std::as_bytes(std::span(&message, 1)), out);
}

/// The message that a payload begins with. A later minor version may have added fields at its end:
/// they are skipped. False: the payload is too short.
template <Message T>
[[nodiscard]] bool decode_message(std::span<const std::byte> payload, T& message) {
  if (payload.size() < sizeof(T)) {
    return false;
  }
  __builtin_memcpy(&message, payload.data(), sizeof(T));
  return true;
}

/// Takes bytes one by one and finds frames among them, after any garbage.
class FrameDecoder {
 public:
  enum class Result : std::uint8_t {
    kNone = 0,  ///< nothing is complete yet
    kFrame,     ///< header() and payload() hold until the next push()
    kDamaged,   ///< something ended that is no frame: it was dropped
  };

  /// Cost: a few instructions; at a delimiter a checksum of the frame, about 10 a byte.
  [[nodiscard]] Result push(std::byte byte);

  [[nodiscard]] const FrameHeader& header() const { return header_; }
  [[nodiscard]] std::span<const std::byte> payload() const {
    return std::span(buffer_).subspan(sizeof(FrameHeader), header_.payload_bytes);
  }

 private:
  void put(std::byte byte);
  [[nodiscard]] Result finish();
  [[nodiscard]] bool is_whole();
  void begin();

  alignas(4) std::byte buffer_[kMaxFrame] = {};
  FrameHeader header_{};
  std::uint32_t size_ = 0;    // decoded bytes in the buffer
  std::uint8_t left_ = 0;     // bytes until the next code
  bool zero_is_due_ = false;  // a zero stands between the run and the next one
  bool empty_ = true;         // nothing since the last delimiter
  bool too_long_ = false;
};

}  // namespace tactree::core::wire
