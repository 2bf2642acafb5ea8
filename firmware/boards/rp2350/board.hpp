#pragma once
// A board with an RP2350 that stands alone: README.md in this folder.
// Loop and memory annotations: docs/BOUND.md.
// memory: RAM

#include "drivers.hpp"
#include "platform.hpp"
#include "runtime/blob_area.hpp"
#include "runtime/deadline_wait.hpp"
#include "tactree/hal/board.hpp"
#include "tactree/hal/loop.hpp"
#include "tactree/hal/panel.hpp"
#include "wiring.hpp"

namespace tactree::firmware {

class Board {
 public:
  /// Refreshes the watchdog at the start of each tick and nowhere else.
  class Ticker {
   public:
    [[nodiscard]] hal::Tick wait() noexcept {
      const std::uint32_t missed = deadline_.wait();
      rp2350::Watchdog().refresh();
      return {missed};
    }
    [[nodiscard]] std::uint32_t now_us() noexcept { return firmware::now_us(); }

   private:
    DeadlineWait deadline_;
  };

  /// healthy() also returns false if any part of the board failed to start.
  class Motors {
   public:
    explicit Motors(Board& board) : board_(board) {}
    void write(const core::MotorCommand& command) noexcept { board_.pwm_.write(command); }
    [[nodiscard]] bool healthy() noexcept { return board_.started_ && board_.pwm_.healthy(); }

   private:
    Board& board_;
  };

  class EnableLine {
   public:
    explicit EnableLine(Board& board) : board_(board) {}
    void set(bool on) noexcept {
      board_.pwm_.connect(on && board_.started_);
      rp2350::Pin(wiring::kEnable).drive(on);
    }
    [[nodiscard]] bool read_back() noexcept { return rp2350::Pin(wiring::kEnableSense).is_high(); }

   private:
    Board& board_;
  };

  /// A port that did not accept its settings reads as the safe state.
  class SafetyInputs {
   public:
    explicit SafetyInputs(Board& board) : board_(board) {}
    [[nodiscard]] bool emergency_stop() noexcept {
      return !board_.started_ || rp2350::Pin(wiring::kEmergencyStop).is_high();
    }
    [[nodiscard]] bool dead_man() noexcept {
      return board_.started_ && !rp2350::Pin(wiring::kDeadMan).is_high();
    }

   private:
    Board& board_;
  };

  /// Button and lamp in the place of an application.
  class Link {
   public:
    explicit Link(Board& board) : board_(board) {}
    [[nodiscard]] hal::LinkInput receive() noexcept {
      hal::LinkInput input;
      const bool pressed = board_.started_ && !rp2350::Pin(wiring::kButton).is_high();
      board_.panel_.operate(pressed, input);
      return input;
    }
    void send(const core::Status& status) noexcept {
      rp2350::Pin(wiring::kLamp).drive(board_.panel_.lamp(status));
    }

   private:
    Board& board_;
  };

  [[nodiscard]] core::Configuration connect(const hal::CapturedFault&);
  /// Starts the watchdog after the check of the model, which takes longer than its timeout.
  void report(const hal::StartResult& result) {
    started_ = rp2350::Watchdog().start() && started_;
    if (result.image != hal::ImageStatus::kOk) {
      panel_.refuse_program();
    }
  }

  [[nodiscard]] rp2350::Encoders& encoders() noexcept { return encoders_; }
  [[nodiscard]] Motors& motors() noexcept { return motors_; }
  [[nodiscard]] EnableLine& enable_line() noexcept { return enable_line_; }
  [[nodiscard]] SafetyInputs& safety_inputs() noexcept { return safety_inputs_; }
  [[nodiscard]] Link& link() noexcept { return link_; }
  [[nodiscard]] const BlobArea& storage() const noexcept { return storage_; }
  [[nodiscard]] Ticker& ticker() noexcept { return ticker_; }

 private:
  rp2350::Encoders encoders_{wiring::kTrackA};
  rp2350::PwmMotors pwm_{wiring::kWidth, wiring::kDirection, wiring::kAmplifiersGood,
                         wiring::kEffortAtFullWidth};
  hal::Panel panel_;
  Motors motors_{*this};
  EnableLine enable_line_{*this};
  SafetyInputs safety_inputs_{*this};
  Link link_{*this};
  BlobArea storage_;
  Ticker ticker_;
  bool started_ = false;
};

static_assert(hal::Board<Board>);

}  // namespace tactree::firmware
