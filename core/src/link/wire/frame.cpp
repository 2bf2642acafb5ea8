// Loop and memory annotations: docs/BOUND.md.

#include "tactree/core/link/wire/frame.hpp"

namespace tactree::core::wire {
namespace {

constexpr std::uint8_t kMaxRunCode = 0xFF;  // code of 254 bytes without a zero after them

/// COBS encoder. The code of a run is written when the run ends.
class CobsWriter {
 public:
  explicit CobsWriter(std::span<std::byte> out) : out_(out) {}

  void put(std::span<const std::byte> bytes) {
    for (const std::byte byte : bytes) {  // bound: bytes_size
      put(byte);
    }
  }

  /// Ends the frame; returns its length.
  std::size_t finish() {
    out_[code_at_] = static_cast<std::byte>(code_);
    out_[next_] = static_cast<std::byte>(kDelimiter);
    return next_ + 1U;
  }

 private:
  void put(std::byte byte) {
    // A full run ends only if a byte follows.
    if (code_ == kMaxRunCode) {
      end_run();
    }
    if (byte == std::byte{0}) {
      end_run();
      return;
    }
    out_[next_] = byte;
    ++next_;
    ++code_;
  }

  void end_run() {
    out_[code_at_] = static_cast<std::byte>(code_);
    code_at_ = next_;
    ++next_;
    code_ = 1;
  }

  std::span<std::byte> out_;
  std::size_t code_at_ = 0;
  std::size_t next_ = 1;
  std::uint8_t code_ = 1;
};

std::uint32_t word_at(const std::byte* bytes) {
  std::uint32_t word = 0;
  __builtin_memcpy(&word, bytes, sizeof word);
  return word;
}

}  // namespace

std::size_t encode_frame(FrameHeader header, std::span<const std::byte> payload,
                         std::span<std::byte> out) {
  if (payload.size() > kMaxPayload || out.size() < kMaxEncodedFrame) {
    return 0;
  }
  header.payload_bytes = static_cast<std::uint16_t>(payload.size());
  const auto head = std::as_bytes(std::span(&header, 1));
  Crc32 crc;
  crc.update(head);
  crc.update(payload);
  const std::uint32_t checksum = crc.value();

  CobsWriter writer(out);
  writer.put(head);
  writer.put(payload);
  writer.put(std::as_bytes(std::span(&checksum, 1)));
  return writer.finish();
}

void FrameDecoder::begin() {
  size_ = 0;
  left_ = 0;
  zero_is_due_ = false;
  empty_ = true;
  too_long_ = false;
}

void FrameDecoder::put(std::byte byte) {
  if (size_ == kMaxFrame) {
    too_long_ = true;
    return;
  }
  buffer_[size_] = byte;
  ++size_;
}

FrameDecoder::Result FrameDecoder::push(std::byte byte) {
  if (byte == static_cast<std::byte>(kDelimiter)) {
    return finish();
  }
  empty_ = false;
  if (left_ > 0U) {
    --left_;
    put(byte);
    return Result::kNone;
  }
  if (zero_is_due_) {
    put(std::byte{0});
  }
  const auto code = static_cast<std::uint8_t>(byte);
  left_ = static_cast<std::uint8_t>(code - 1U);
  zero_is_due_ = code != kMaxRunCode;
  return Result::kNone;
}

FrameDecoder::Result FrameDecoder::finish() {
  const bool empty = empty_;  // repeated delimiters are allowed
  const bool whole = left_ == 0U && !too_long_ && is_whole();
  begin();
  if (empty) {
    return Result::kNone;
  }
  return whole ? Result::kFrame : Result::kDamaged;
}

bool FrameDecoder::is_whole() {
  constexpr std::uint32_t kLeast = sizeof(FrameHeader) + kFrameChecksumBytes;
  if (size_ < kLeast) {
    return false;
  }
  const std::uint32_t sealed = size_ - kFrameChecksumBytes;
  if (crc32(std::span(buffer_).first(sealed)) != word_at(buffer_ + sealed)) {
    return false;
  }
  __builtin_memcpy(&header_, buffer_, sizeof header_);
  return header_.payload_bytes == size_ - kLeast;
}

}  // namespace tactree::core::wire
