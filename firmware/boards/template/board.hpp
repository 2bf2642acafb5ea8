#pragma once
// Template of a board. It boots, reports every part as missing and gives no force: each part
// behaves as a failed part. Complete the CHANGEs from top to bottom and run the conformance program
// after each: docs/PORTING.md.

#include "platform.hpp"
#include "runtime/blob_area.hpp"
#include "runtime/deadline_wait.hpp"
#include "tactree/hal/board.hpp"
#include "tactree/hal/loop.hpp"

namespace tactree::firmware {

class Board {
 public:
  /// Needs no change.
  class Ticker {
   public:
    // CHANGE: feed your watchdog here and nowhere else.
    [[nodiscard]] hal::Tick wait() noexcept { return {deadline_.wait()}; }
    [[nodiscard]] std::uint32_t now_us() noexcept { return firmware::now_us(); }

   private:
    DeadlineWait deadline_;
  };

  class Encoders {
   public:
    // CHANGE: latch all counters at one instant; extend them to 32 bits; valid only while a counter
    // runs as configured. The index pulse is needed only for homing by index.
    [[nodiscard]] core::EncoderReading read() noexcept { return {}; }
  };

  class Motors {
   public:
    // CHANGE: command.effort(axis) is N or Nm; hold it until the next write.
    void write(const core::MotorCommand&) noexcept {}
    // CHANGE: true if no amplifier reports a failure and the last command was delivered.
    [[nodiscard]] bool healthy() noexcept { return false; }
  };

  class EnableLine {
   public:
    // CHANGE: power of the amplifiers. A broken wire must mean off.
    void set(bool) noexcept {}
    // CHANGE: the level measured at the amplifiers, not the level set.
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
    // CHANGE: drop the status if there is no room; never wait.
    void send(const core::Status&) noexcept {}
  };

  /// Starts every part. CHANGE: use_device() of tactree/core/configuration/device_presets.hpp, and
  /// your values.
  [[nodiscard]] core::Configuration connect(const hal::CapturedFault&) { return {}; }
  /// Receives the result of the start. CHANGE: report it, and start the watchdog: the check of a
  /// large model takes longer than the timeout of a watchdog.
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
