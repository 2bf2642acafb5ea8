#pragma once
// Frames of the wire protocol: header, payload, CRC-32; COBS-encoded and terminated by a zero byte.
// A reader that joins late or loses bytes resynchronises at the next zero. Serial ports,
// pseudo-terminals and USB packets carry the same bytes; a packet may split a frame anywhere.
// (S. Cheshire, M. Baker, "Consistent Overhead Byte Stuffing", IEEE/ACM ToN 7(2), 1999.)
// Specification: docs/PROTOCOL.md.
//
// Interrupt safety: no shared state; one context owns a decoder.

#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>

#include "tactree/core/math/crc32.hpp"

namespace tactree::core::wire {

struct FrameHeader {
  std::uint8_t kind = 0;    ///< MessageKind; with kReplyBit in a reply
  std::uint8_t status = 0;  ///< WireStatus in a reply; else 0
  std::uint16_t sequence = 0;
  std::uint16_t session = 0;  ///< assigned by the board; 0: none
  std::uint16_t payload_bytes = 0;
};
static_assert(sizeof(FrameHeader) == 8 && alignof(FrameHeader) == 2);

/// Large enough for a piece of a model, kMaxPiece bytes, and its header (messages.hpp). A frame of
/// this length is held by the decoder, by the reply and four times by the queue of a session.
inline constexpr std::uint32_t kMaxPayload = 264;
inline constexpr std::uint32_t kFrameChecksumBytes = 4;
/// Header, payload and checksum, before COBS.
inline constexpr std::uint32_t kMaxFrame = 276;
static_assert(kMaxFrame == sizeof(FrameHeader) + kMaxPayload + kFrameChecksumBytes);
/// COBS adds one byte for each started group of 254 bytes, and the zero at the end.
inline constexpr std::uint32_t kMaxEncodedFrame = 279;
static_assert(kMaxEncodedFrame == kMaxFrame + (kMaxFrame + 253U) / 254U + 1U);
/// Ends a frame.
inline constexpr std::uint8_t kDelimiter = 0;

/// Writes a frame to `out` and returns its length including the delimiter. Returns 0 if the payload
/// is longer than kMaxPayload, or `out` is shorter than kMaxEncodedFrame. Sets
/// `header.payload_bytes`. Cost: about 25 instructions per byte.
[[nodiscard]] std::size_t encode_frame(FrameHeader header, std::span<const std::byte> payload,
                                       std::span<std::byte> out);

/// A message with the same layout in memory as on the wire.
template <class T>
concept Message = std::is_aggregate_v<T> && std::is_trivially_copyable_v<T> &&
                  sizeof(T) <= kMaxPayload;

/// Reads the message at the beginning of a payload. Ignores the bytes after it, because later minor
/// versions may append fields. Returns false if the payload is too short.
template <Message T>
[[nodiscard]] bool decode_message(std::span<const std::byte> payload, T& message) {
  if (payload.size() < sizeof(T)) {
    return false;
  }
  __builtin_memcpy(&message, payload.data(), sizeof(T));
  return true;
}

/// Extracts frames from a stream of bytes; skips garbage.
class FrameDecoder {
 public:
  enum class Result : std::uint8_t {
    kNone = 0,  ///< no frame is complete yet
    kFrame,     ///< a frame; header() and payload() are valid until the next push()
    kDamaged,   ///< bytes that do not form a frame were dropped
  };

  /// Cost: a few instructions; at a delimiter the checksum of the frame, about 10 per byte.
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
  bool zero_is_due_ = false;  // a zero separates this run from the next
  bool empty_ = true;         // no byte since the last delimiter
  bool too_long_ = false;
};

}  // namespace tactree::core::wire
