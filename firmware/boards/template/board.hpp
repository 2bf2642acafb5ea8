#pragma once
// Template of a board. It boots and keeps the motors off, because each part behaves like a failed
// part. Complete the lines marked CHANGE from top to bottom and run the conformance program after
// each of them: docs/PORTING.md.

#include "platform.hpp"
#include "runtime/blob_area.hpp"
#include "runtime/deadline_wait.hpp"
#include "tactree/hal/board.hpp"
#include "tactree/hal/loop.hpp"

namespace tactree::firmware {

class Board {
 public:
  /// Complete, except for the watchdog.
  class Ticker {
   public:
    // CHANGE: refresh your watchdog here and nowhere else.
    [[nodiscard]] hal::Tick wait() noexcept { return {deadline_.wait()}; }
    [[nodiscard]] std::uint32_t now_us() noexcept { return firmware::now_us(); }

   private:
    DeadlineWait deadline_;
  };

  class Encoders {
   public:
    // CHANGE: latch all counters at one instant and extend them to 32 bits. An axis is valid only
    // while its counter runs as configured. The index pulse is needed only for homing by index.
    [[nodiscard]] core::EncoderReading read() noexcept { return {}; }
  };

  class Motors {
   public:
    // CHANGE: apply command.effort(axis), N or Nm, and hold it until the next write.
    void write(const core::MotorCommand&) noexcept {}
    // CHANGE: return true if no amplifier reports a failure and the last command was delivered.
    [[nodiscard]] bool healthy() noexcept { return false; }
  };

  class EnableLine {
   public:
    // CHANGE: switch the power of the amplifiers. A broken wire must switch it off.
    void set(bool) noexcept {}
    // CHANGE: return the level measured at the amplifiers, not the level set.
    [[nodiscard]] bool read_back() noexcept { return false; }
  };

  class SafetyInputs {
   public:
    // CHANGE: a broken wire, or a port that did not start, must read as pressed.
    [[nodiscard]] bool emergency_stop() noexcept { return true; }
    // CHANGE: a broken wire must read as released.
    [[nodiscard]] bool dead_man() noexcept { return false; }
  };

  class Link {
   public:
    // CHANGE: return each valid command once; ignore messages that fail their checks.
    [[nodiscard]] hal::LinkInput receive() noexcept { return {}; }
    // CHANGE: send the status. Drop it if there is no room; never wait.
    void send(const core::Status&) noexcept {}
  };

  /// Starts every part. CHANGE: call use_device() of tactree/core/configuration/device_presets.hpp
  /// and set your own values.
  [[nodiscard]] core::Configuration connect(const hal::CapturedFault&) { return {}; }
  /// Receives the result of the start. CHANGE: report it, then start the watchdog. It must not
  /// start earlier, because the check of a large model takes longer than the timeout of a watchdog.
  void report(const hal::StartResult&) {}

  [[nodiscard]] Encoders& encoders() noexcept { return encoders_; }
  [[nodiscard]] Motors& motors() noexcept { return motors_; }
  [[nodiscard]] EnableLine& enable_line() noexcept { return enable_line_; }
  [[nodiscard]] SafetyInputs& safety_inputs() noexcept { return safety_inputs_; }
  [[nodiscard]] Link& link() noexcept { return link_; }
  [[nodiscard]] const BlobArea& storage() const noexcept { return storage_; }
  [[nodiscard]] Ticker& ticker() noexcept { return ticker_; }

 private:
  Encoders encoders_;
  Motors motors_;
  EnableLine enable_line_;
  SafetyInputs safety_inputs_;
  Link link_;
  BlobArea storage_;
  Ticker ticker_;
};

static_assert(hal::Board<Board>);

}  // namespace tactree::firmware
