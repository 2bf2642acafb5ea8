#pragma once
// A simulated board: every component satisfies the contract of board.hpp, with faults and delays as
// parameters. The simulation calls sample() with the position before each tick of the loop and
// effort() after it. Not thread safe.

#include <cstddef>
#include <cstdint>
#include <span>

#include "tactree/hal/board.hpp"
#include "tactree/hal/panel.hpp"
#include "tactree/hal/sim/encoder_bank.hpp"
#include "tactree/hal/sim/motor_bank.hpp"
#include "tactree/hal/sim/session_recorder.hpp"

namespace tactree::hal::sim {

struct BoardParameters {
  EncoderParameters encoders{};
  MotorParameters motors{};
  std::uint32_t period_us = 1000;        ///< tick period: 1 .. 1e6
  float rate_hz = 1000.0F;               ///< of the panel's times: that of the configuration
  std::uint32_t enable_delay_ticks = 5;  ///< delay until amplifier power and read-back follow
  SessionRecorder* recorder = nullptr;   ///< records the session; must outlive the board
};

/// Enable line with the delay of a relay, which can stick.
class SimEnableLine {
 public:
  explicit SimEnableLine(std::uint32_t delay_ticks) : line_(delay_ticks, false) {}
  void set(bool on) noexcept { wanted_ = on; }
  [[nodiscard]] bool read_back() noexcept { return stuck_ ? stuck_at_ : line_.value(); }

  /// Call once per tick.
  void advance() { line_.push(wanted_); }
  void stick(bool at) {
    stuck_ = true;
    stuck_at_ = at;
  }
  void unstick() { stuck_ = false; }

 private:
  DelayLine<bool> line_;
  bool wanted_ = false;
  bool stuck_ = false;
  bool stuck_at_ = false;
};

class SimSafetyInputs {
 public:
  [[nodiscard]] bool emergency_stop() noexcept { return emergency_stop_; }
  [[nodiscard]] bool dead_man() noexcept { return dead_man_; }
  void press_emergency_stop(bool pressed) { emergency_stop_ = pressed; }
  void hold_dead_man(bool held) { dead_man_ = held; }

 private:
  bool emergency_stop_ = false;
  bool dead_man_ = false;
};

/// Simulated time: a wait takes exactly one period plus the injected overruns.
class SimTicker {
 public:
  /// Each wait() advances `line` by one tick. It must outlive the ticker.
  SimTicker(std::uint32_t period_us, SimEnableLine& line) : period_us_(period_us), line_(line) {}
  [[nodiscard]] Tick wait() noexcept {
    const Tick tick{overruns_};
    now_us_ += period_us_ * (1U + overruns_);
    overruns_ = 0;
    line_.advance();
    return tick;
  }
  [[nodiscard]] std::uint32_t now_us() noexcept { return now_us_; }

  /// The next wait() reports this number of missed deadlines.
  void miss(std::uint32_t deadlines) { overruns_ = deadlines; }

 private:
  std::uint32_t period_us_;
  SimEnableLine& line_;
  std::uint32_t now_us_ = 0;
  std::uint32_t overruns_ = 0;
};

/// Button and lamp of the board.
class SimPanel {
 public:
  explicit SimPanel(float rate_hz) { panel_.configure(rate_hz); }
  [[nodiscard]] bool is_pressed() const { return pressed_; }
  [[nodiscard]] bool is_lit() const { return lit_; }
  void press(bool pressed) { pressed_ = pressed; }
  /// For a board in an emulator, which operates the lamp.
  void light(bool lit) { lit_ = lit; }

  // Call each of these once per tick, as those of hal::Panel.
  void operate(LinkInput& input) noexcept { panel_.operate(pressed_, input); }
  void show(const core::Status& status) noexcept { lit_ = panel_.lamp(status); }

 private:
  Panel panel_;
  bool pressed_ = false;
  bool lit_ = false;
};

/// Link to a simulated application, with the commands of the panel.
class SimLink {
 public:
  /// `panel` must outlive the link.
  explicit SimLink(SimPanel& panel) : panel_(panel) {}
  [[nodiscard]] LinkInput receive() noexcept {
    LinkInput input = take_message();
    panel_.operate(input);
    return input;
  }
  void send(const core::Status& status) noexcept {
    last_ = status;
    panel_.show(status);
  }

  /// receive() without the panel, for a board in an emulator, which reads the button.
  [[nodiscard]] LinkInput take_message() noexcept {
    const LinkInput input = next_;
    next_ = {};
    return input;
  }

  /// The next receive() returns a message with this command (kNone: keep-alive).
  void post(core::Command command) { next_ = {true, command, {}}; }
  /// Adds this update to the posted message. Has no effect without one.
  void attach(const BodyUpdate& update) {
    body_ = update;
    next_.bodies = std::span(&body_, next_.alive ? 1U : 0U);
  }
  /// The next receive() returns these updates, even without a message, like those of an application
  /// on the board. `updates` must stay valid until the end of the tick.
  void move_bodies(std::span<const BodyUpdate> updates) { next_.bodies = updates; }
  /// The next receive() returns this force.
  void add_force(const core::AddedForce& force) { next_.added_force = force; }
  /// Drops the pending input.
  void cut() { next_ = {}; }
  [[nodiscard]] const core::Status& last() const { return last_; }

 private:
  SimPanel& panel_;
  LinkInput next_{};
  BodyUpdate body_{};
  core::Status last_{};
};

class SimStorage {
 public:
  explicit SimStorage(std::span<const std::byte> bytes) : bytes_(bytes) {}
  [[nodiscard]] std::span<const std::byte> active() const noexcept { return bytes_; }

 private:
  std::span<const std::byte> bytes_;
};

class SimBoard {
 public:
  /// `blob` is kept by reference and must outlive the board.
  SimBoard(const BoardParameters& parameters, std::span<const std::byte> blob)
      : encoders_(parameters.encoders),
        motors_(parameters.motors),
        enable_line_(parameters.enable_delay_ticks),
        panel_(parameters.rate_hz),
        ticker_(parameters.period_us, enable_line_),
        link_(panel_),
        storage_(blob),
        recorder_(parameters.recorder) {}

  SimBoard(const SimBoard&) = delete;
  SimBoard& operator=(const SimBoard&) = delete;

  [[nodiscard]] SimEncoderBank& encoders() noexcept { return encoders_; }
  [[nodiscard]] SimMotorBank& motors() noexcept { return motors_; }
  [[nodiscard]] SimEnableLine& enable_line() noexcept { return enable_line_; }
  [[nodiscard]] SimSafetyInputs& safety_inputs() noexcept { return inputs_; }
  [[nodiscard]] SimPanel& panel() noexcept { return panel_; }
  [[nodiscard]] SimTicker& ticker() noexcept { return ticker_; }
  [[nodiscard]] SimLink& link() noexcept { return link_; }
  [[nodiscard]] SimStorage& storage() noexcept { return storage_; }
  /// Returns nullptr if there is none.
  [[nodiscard]] SessionRecorder* recorder() noexcept { return recorder_; }

  /// Sets the positions of the axes, m. Call once per tick, before the tick of the loop.
  void sample(const double (&position_m)[core::kAxes]) { encoders_.sample(position_m); }
  /// Effort of an axis, N or Nm; zero while the read-back is off. Precondition: axis < kAxes.
  [[nodiscard]] double effort(std::uint32_t axis) {
    return motors_.effort(axis, enable_line_.read_back());
  }

 private:
  SimEncoderBank encoders_;
  SimMotorBank motors_;
  SimEnableLine enable_line_;
  SimSafetyInputs inputs_;
  SimPanel panel_;
  SimTicker ticker_;
  SimLink link_;
  SimStorage storage_;
  SessionRecorder* recorder_;
};

static_assert(Board<SimBoard>);

}  // namespace tactree::hal::sim
