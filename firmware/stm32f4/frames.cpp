// memory: RAM

#include "stm32f4/frames.hpp"

#include <bit>

namespace tactree::firmware::stm32f4 {

static_assert(kFrameMark != kCommandKind);
static_assert(kFrameMark > static_cast<std::uint8_t>(core::Command::kHome));
static_assert(kCommandKind > static_cast<std::uint8_t>(core::Command::kHome));
static_assert(kLookedAt % 4U == 0U);

bool CommandReader::push(std::byte byte, core::Command& command) {
  window_ = (window_ >> 8U) | (static_cast<std::uint64_t>(byte) << 56U);
  const auto frame = std::bit_cast<CommandFrame>(window_);
  if (frame.mark != kFrameMark || frame.kind != kCommandKind ||
      frame.command > core::Command::kHome) {
    return false;
  }
  // No frame looks like one that begins one to three bytes later.
  // at most: kLookedAt / 4 per tactree_tick
  const std::uint32_t checksum = checksum_of(frame);  // with: bytes_size <= 4
  if (frame.checksum != checksum) {
    return false;
  }
  const bool repeated = !first_ && frame.sequence == last_sequence_;
  first_ = false;
  last_sequence_ = frame.sequence;
  command = frame.command;
  return !repeated;
}

}  // namespace tactree::firmware::stm32f4
