#pragma once
// The contracts of tactree/hal/board.hpp on an imaginary controller, the HC-3: one block of
// registers with three counters, three amplifiers, switches and a mailbox.

#include <cstdint>
#include <span>

#include "tactree/core/configuration/device_presets.hpp"
#include "tactree/core/model/blob_format.hpp"
#include "tactree/hal/board.hpp"

namespace hc3 {

using tactree::core::kAxes;

struct Registers {
  std::uint32_t latch;  // a write copies all counters to `count` at one instant
  std::int32_t count[kAxes];
  std::uint32_t count_bad;  // bit n: the wires of axis n are broken
  float torque_Nm[kAxes];
  std::uint32_t amplifier_failed;  // bit n: of axis n
  std::uint32_t power;             // 1: the amplifiers are to have power
  std::uint32_t power_measured;
  std::uint32_t switches;  // bit 0: stop released, bit 1: dead-man control held
  std::uint32_t ticks;     // deadlines since the start, at 1 kHz
  std::uint32_t microseconds;
  std::uint32_t watchdog;     // a write feeds it
  std::uint32_t mail_number;  // of the last message that passed its checks
  std::uint32_t mail_command;
  std::uint32_t status_faults;  // what the other processor sends on
  std::uint32_t status_state;
};

inline volatile Registers& registers() {
  return *reinterpret_cast<volatile Registers*>(0x40000000);
}
inline constexpr std::uint32_t kBlobAddress = 0x08020000;
inline constexpr std::uint32_t kBlobRoom = 896 * 1024;

struct Encoders {
  tactree::core::EncoderReading read() noexcept {
    registers().latch = 1;
    tactree::core::EncoderReading reading;
    for (std::uint32_t axis = 0; axis < kAxes; ++axis) {  // bound: kAxes
      reading.counts[axis] = registers().count[axis];
      reading.valid[axis] = (registers().count_bad & (1U << axis)) == 0U;
    }
    return reading;
  }
};

struct Motors {
  void write(const tactree::core::MotorCommand& command) noexcept {
    for (std::uint32_t axis = 0; axis < kAxes; ++axis) {  // bound: kAxes
      registers().torque_Nm[axis] = command.effort(axis);
    }
  }
  bool healthy() noexcept { return registers().amplifier_failed == 0U; }
};

struct EnableLine {
  void set(bool on) noexcept { registers().power = on ? 1U : 0U; }
  bool read_back() noexcept { return registers().power_measured == 1U; }
};

struct SafetyInputs {
  bool emergency_stop() noexcept { return (registers().switches & 1U) == 0U; }
  bool dead_man() noexcept { return (registers().switches & 2U) != 0U; }
};

struct Ticker {
  tactree::hal::Tick wait() noexcept {
    while (registers().ticks == seen) {  // bound: 0 (a tick begins with its deadline)
    }
    const std::uint32_t missed = registers().ticks - seen - 1U;
    seen += missed + 1U;
    registers().watchdog = 1;
    return {missed};
  }
  std::uint32_t now_us() noexcept { return registers().microseconds; }
  std::uint32_t seen = 0;
};

struct Link {
  tactree::hal::LinkInput receive() noexcept {
    const std::uint32_t number = registers().mail_number;
    if (number == last) {
      return {};
    }
    last = number;
    return {true, static_cast<tactree::core::Command>(registers().mail_command)};
  }
  void send(const tactree::core::Status& status) noexcept {
    registers().status_faults = status.faults;
    registers().status_state = static_cast<std::uint32_t>(status.state);
  }
  std::uint32_t last = 0;
};

struct Storage {
  std::span<const std::byte> active() const noexcept {
    const auto* const blob = reinterpret_cast<const std::byte*>(kBlobAddress);
    const auto& header = *reinterpret_cast<const tactree::core::BlobHeader*>(blob);
    return {blob, header.total_bytes < kBlobRoom ? header.total_bytes : kBlobRoom};
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

}  // namespace hc3
