#include "stm32f4/frames.hpp"

#include <bit>

namespace tactree::firmware::stm32f4 {

bool CommandReader::push(std::byte byte, core::Command& command) {
  for (std::size_t i = 0; i + 1 < sizeof window_; ++i) {  // bound: 7
    window_[i] = window_[i + 1];
  }
  window_[sizeof window_ - 1] = byte;
  struct Bytes {
    std::byte byte[sizeof(CommandFrame)];
  } bytes;
  for (std::size_t i = 0; i < sizeof window_; ++i) {  // bound: 8
    bytes.byte[i] = window_[i];
  }
  const auto frame = std::bit_cast<CommandFrame>(bytes);
  if (frame.mark != kFrameMark || frame.kind != kCommandKind ||
      frame.command > core::Command::kHome ||
      frame.checksum != checksum_of(frame)) {  // with: bytes_size <= 4
    return false;
  }
  const bool repeated = !first_ && frame.sequence == last_sequence_;
  first_ = false;
  last_sequence_ = frame.sequence;
  command = frame.command;
  return !repeated;
}

}  // namespace tactree::firmware::stm32f4
