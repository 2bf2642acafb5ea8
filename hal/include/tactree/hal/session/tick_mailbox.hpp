#pragma once
// What the control loop and a session give each other. The loop ticks from an interrupt, a session
// works in the time between: the tick may come at any moment, takes what is complete, and never
// waits. On the board it is the Link of the loop, or a part of it.
//
//   session -> tick   one command, one body, one force, one sign of life: each in a box that the
//                     tick empties
//   tick -> session   a Status where somebody wants it, in a ring of kWaiting
//
// One core; the tick interrupts the session and not the other way round.

#include <cstdint>

#include "tactree/hal/board.hpp"

namespace tactree::hal {

/// One value on its way from the session to the tick.
template <class T>
class Box {
 public:
  [[nodiscard]] bool full() const { return __atomic_load_n(&full_, __ATOMIC_ACQUIRE); }
  /// Of the session. What was there and not taken yet is replaced.
  void put(const T& value) {
    clear();
    value_ = value;
    __atomic_store_n(&full_, true, __ATOMIC_RELEASE);
  }
  void clear() { __atomic_store_n(&full_, false, __ATOMIC_RELEASE); }
  [[nodiscard]] const T& value() const { return value_; }

 private:
  T value_{};
  bool full_ = false;
};

/// A tick's status on its way to a session.
struct TickReport {
  core::Status status{};
  std::uint32_t time_us = 0;
  bool telemetry = false;  ///< of the subscription; else somebody asked for it
};

class TickMailbox {
 public:
  static constexpr std::uint32_t kWaiting = 4;

  // ---- in the tick: Link::receive() and Link::send()

  [[nodiscard]] LinkInput receive() noexcept {
    LinkInput input;
    take_command(input);
    if (sign_.full()) {
      input.alive = true;
      input.age_ticks = sign_.value();
      sign_.clear();
    }
    if (body_.full()) {
      input.body = body_.value();
      body_.clear();
    }
    if (force_.full()) {
      input.force_N = force_.value().force_N;
      input.force_ticks = force_.value().ticks;
      force_.clear();
    }
    input.storage_busy = storage_busy_;
    return input;
  }

  void send(const core::Status& status, std::uint32_t time_us) noexcept {
    const bool asked = asked_;
    const bool due = decimation_ != 0U && ++ticks_ >= decimation_;
    if (due) {
      ticks_ = 0;
    }
    if (asked || due) {
      push(status, time_us, due);
    }
  }

  // ---- in the session

  struct Force {
    core::Vec3 force_N{};
    std::uint32_t ticks = 0;
  };

  /// Before every command that was posted and not taken.
  void post_stop() {
    command_.clear();
    __atomic_store_n(&stop_, true, __ATOMIC_RELEASE);
  }
  /// False: the one before it has not been taken yet.
  [[nodiscard]] bool post_command(core::Command command) {
    if (stop_ || command_.full()) {
      return false;
    }
    command_.put(command);
    return true;
  }
  /// Likewise; but of the same body the newest counts.
  [[nodiscard]] bool post_body(const BodyUpdate& update) {
    if (body_.full() && body_.value().body != update.body) {
      return false;
    }
    body_.put(update);
    return true;
  }
  void post_force(const Force& force) { force_.put(force); }
  void post_sign_of_life(std::uint16_t age_ticks) { sign_.put(age_ticks); }
  void set_storage_busy(bool busy) { __atomic_store_n(&storage_busy_, busy, __ATOMIC_RELEASE); }

  /// A report of a tick that begins from now on will come.
  void ask() { __atomic_store_n(&asked_, true, __ATOMIC_RELEASE); }
  /// A report every `decimation` ticks; 0: none.
  void subscribe(std::uint32_t decimation) {
    __atomic_store_n(&decimation_, decimation, __ATOMIC_RELEASE);
    dropped_ = 0;
  }
  /// The oldest report; nullptr: there is none.
  [[nodiscard]] const TickReport* front() const {
    return __atomic_load_n(&written_, __ATOMIC_ACQUIRE) == read_ ? nullptr
                                                                 : &ring_[read_ % kWaiting];
  }
  void pop() { __atomic_store_n(&read_, read_ + 1U, __ATOMIC_RELEASE); }
  /// Reports that found no room since subscribe().
  [[nodiscard]] std::uint32_t dropped() const { return dropped_; }
  void count_dropped() { ++dropped_; }

 private:
  void take_command(LinkInput& input) {
    if (stop_) {
      input.command = core::Command::kStop;
      stop_ = false;
    } else if (command_.full()) {
      input.command = command_.value();
      command_.clear();
    }
  }

  void push(const core::Status& status, std::uint32_t time_us, bool due) {
    if (written_ - __atomic_load_n(&read_, __ATOMIC_ACQUIRE) == kWaiting) {
      dropped_ += due ? 1U : 0U;
      return;
    }
    ring_[written_ % kWaiting] = {status, time_us, due};
    asked_ = false;
    __atomic_store_n(&written_, written_ + 1U, __ATOMIC_RELEASE);
  }

  Box<core::Command> command_{};
  Box<BodyUpdate> body_{};
  Box<Force> force_{};
  Box<std::uint16_t> sign_{};
  bool stop_ = false;
  bool storage_busy_ = false;
  bool asked_ = false;
  std::uint32_t decimation_ = 0;
  std::uint32_t ticks_ = 0;
  std::uint32_t written_ = 0;
  std::uint32_t read_ = 0;
  std::uint32_t dropped_ = 0;
  TickReport ring_[kWaiting]{};
};

/// The Link of a board whose ticks talk to nobody but a session.
template <class Ticker>
struct MailboxLink {
  TickMailbox& mailbox;
  Ticker& ticker;
  [[nodiscard]] LinkInput receive() noexcept { return mailbox.receive(); }
  void send(const core::Status& status) noexcept { mailbox.send(status, ticker.now_us()); }
};

}  // namespace tactree::hal
