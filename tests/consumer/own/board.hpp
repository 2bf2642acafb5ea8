#pragma once
// A board whose parts are variables: a device at rest, above its model.

#include <cstdint>
#include <span>

#include "tactree/core/model/blob_format.hpp"
#include "tactree/hal/board.hpp"

namespace own {

inline constexpr std::uint32_t kModelAddress = 0x21000000;
inline constexpr std::uint32_t kModelRoom = 1 << 20;

struct Encoders {
  tactree::core::EncoderReading read() noexcept {
    tactree::core::EncoderReading reading;
    for (std::uint32_t axis = 0; axis < tactree::core::kAxes; ++axis) {  // bound: kAxes
      reading.valid[axis] = true;
    }
    return reading;
  }
};

struct Motors {
  void write(const tactree::core::MotorCommand& command) noexcept { effort = command.effort(0); }
  bool healthy() noexcept { return true; }
  volatile float effort = 0.0F;
};

struct EnableLine {
  void set(bool on) noexcept { level = on; }
  bool read_back() noexcept { return level; }
  volatile bool level = false;
};

struct SafetyInputs {
  bool emergency_stop() noexcept { return false; }
  bool dead_man() noexcept { return false; }
};

struct Ticker {
  tactree::hal::Tick wait() noexcept { return {0}; }
  std::uint32_t now_us() noexcept { return 0; }
};

struct Link {
  tactree::hal::LinkInput receive() noexcept { return {}; }
  void send(const tactree::core::Status& status) noexcept { state = status.state; }
  tactree::core::State state = tactree::core::State::kBoot;
};

struct Storage {
  std::span<const std::byte> active() const noexcept {
    const auto* const begin = reinterpret_cast<const std::byte*>(kModelAddress);
    const auto& header = *reinterpret_cast<const tactree::core::BlobHeader*>(begin);
    return {begin, header.total_bytes < kModelRoom ? header.total_bytes : kModelRoom};
  }
};

class Board {
 public:
  Encoders& encoders() noexcept { return encoders_; }
  Motors& motors() noexcept { return motors_; }
  EnableLine& enable_line() noexcept { return enable_line_; }
  SafetyInputs& safety_inputs() noexcept { return safety_inputs_; }
  Ticker& ticker() noexcept { return ticker_; }
  Link& link() noexcept { return link_; }
  const Storage& storage() const noexcept { return storage_; }

 private:
  Encoders encoders_;
  Motors motors_;
  EnableLine enable_line_;
  SafetyInputs safety_inputs_;
  Ticker ticker_;
  Link link_;
  Storage storage_;
};
static_assert(tactree::hal::Board<Board>);

}  // namespace own
