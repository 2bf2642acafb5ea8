#pragma once
// The link to an application over a serial port: frames.hpp.

#include <cstddef>
#include <cstdint>
#include <span>

#include "stm32f4/frames.hpp"
#include "stm32f4/serial_port.hpp"
#include "tactree/hal/board.hpp"

namespace tactree::firmware::stm32f4 {

template <class Word>
class SerialLink {
 public:
  explicit SerialLink(SerialPort<Word>& port) : port_(port) {}

  /// Tells how the board started; a status has to wait until this is out.
  void tell(const BootFrame& boot) {
    boot_ = boot;
    boot_.checksum = checksum_of(boot_);
    port_.send(std::as_bytes(std::span(&boot_, 1)));
  }

  /// At most one command a tick; what came in after it is read in the next.
  [[nodiscard]] hal::LinkInput receive() noexcept {
    std::byte byte;
    core::Command command = core::Command::kNone;
    hal::LinkInput input;
    for (std::uint32_t i = 0; i < kLookedAt && port_.take(byte); ++i) {  // bound: kLookedAt
      if (!reader_.push(byte, command)) {
        continue;
      }
      input.alive = true;
      if (command != core::Command::kNone) {
        input.command = command;
        return input;
      }
    }
    return input;
  }

  /// Dropped while an older one is on its way.
  void send(const core::Status& status) noexcept {
    if (port_.idle()) {
      ++frame_.sequence;
      frame_.state = status.state;
      frame_.tick = status.tick;
      frame_.faults = status.faults;
      frame_.limits = status.limits;
      frame_.probe_m = status.probe;
      frame_.force_N = status.force;
      frame_.checksum = checksum_of(frame_);
      port_.send(std::as_bytes(std::span(&frame_, 1)));
    }
    port_.advance();
  }

 private:
  SerialPort<Word>& port_;
  CommandReader reader_{};
  BootFrame boot_{};
  StatusFrame frame_{};
};

}  // namespace tactree::firmware::stm32f4
