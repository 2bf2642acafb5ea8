#pragma once
// Messages on the serial port: structs as they lie in memory, little-endian, each with a checksum
// over all before it. A reader finds a frame by its two first bytes and its checksum.

#include <cstddef>
#include <cstdint>
#include <span>

#include "stm32f4/clocks.hpp"
#include "tactree/core/controller.hpp"
#include "tactree/core/crc32.hpp"
#include "tactree/hal/captured_fault.hpp"
#include "tactree/hal/loop.hpp"

namespace tactree::firmware::stm32f4 {

inline constexpr std::uint8_t kFrameMark = 'T';
inline constexpr std::uint8_t kCommandKind = 'c';
inline constexpr std::uint8_t kStatusKind = 's';
inline constexpr std::uint8_t kBootKind = 'b';

/// To the board. A frame with the sequence number of the one before it is a repetition and dropped.
/// kNone is a sign of life.
struct CommandFrame {
  std::uint8_t mark = kFrameMark;
  std::uint8_t kind = kCommandKind;
  std::uint8_t sequence = 0;
  core::Command command = core::Command::kNone;
  std::uint32_t checksum = 0;
};

/// From the board, as often as the port can take it.
struct StatusFrame {
  std::uint8_t mark = kFrameMark;
  std::uint8_t kind = kStatusKind;
  std::uint8_t sequence = 0;
  core::State state = core::State::kBoot;
  std::uint32_t tick = 0;
  core::FaultMask faults = 0;
  core::LimitMask limits = 0;
  core::Vec3 probe_m{};
  core::Vec3 force_N{};
  std::uint32_t checksum = 0;
};

/// Parts of the board that did not start.
enum class Part : std::uint8_t {
  kEncoders = 1U << 0,
  kMotors = 1U << 1,
  kEnableLine = 1U << 2,
  kSafetyInputs = 1U << 3,
  kWatchdog = 1U << 4,
};

/// From the board, once after each reset: is there something to touch, and if not, why.
struct BootFrame {
  std::uint8_t mark = kFrameMark;
  std::uint8_t kind = kBootKind;
  std::uint8_t version = 1;
  ClockFailure clocks = ClockFailure::kNone;
  std::uint8_t failed_parts = 0;
  bool reset_by_watchdog = false;
  hal::StartResult result{};
  std::uint8_t reserved[2] = {};
  hal::CapturedFault last_fault{};
  std::uint32_t checksum = 0;
};

static_assert(sizeof(CommandFrame) == 8);
static_assert(sizeof(StatusFrame) == 44 && offsetof(StatusFrame, probe_m) == 16);
static_assert(sizeof(BootFrame) == 92 && offsetof(BootFrame, last_fault) == 12);

/// Checksum of a frame: of all bytes but its last four.
template <class Frame>
std::uint32_t checksum_of(const Frame& frame) {
  // with: bytes_size <= 88 (of the longest, a BootFrame)
  return core::crc32(std::as_bytes(std::span(&frame, 1)).first(sizeof frame - 4U));
}

/// Bytes of a tick: as many as a line at 115 200 baud brings in from 960 Hz on; what comes faster
/// waits in the ring.
inline constexpr std::uint32_t kLookedAt = 12;

/// Takes bytes one by one and finds command frames among them, after any garbage.
/// Cost of a byte: a few instructions; a checksum of four bytes where one looks like a frame.
class CommandReader {
 public:
  /// True: `command` is that of a valid frame that ends with this byte.
  [[nodiscard]] bool push(std::byte byte, core::Command& command);

 private:
  std::uint64_t window_ = 0;  // the last bytes, the newest on top
  static_assert(sizeof window_ == sizeof(CommandFrame));
  std::uint8_t last_sequence_ = 0;
  bool first_ = true;
};

}  // namespace tactree::firmware::stm32f4
