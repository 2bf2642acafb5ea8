#pragma once
// Exchanges data between the control loop, whose ticks run in an interrupt, and a session, which
// runs between ticks. On a board it is the Link of the loop, or a part of it.
//
//   session -> tick   one command, one body update, one force, one heartbeat: each in a Box
//   tick -> session   requested and subscribed Status values, in a ring of kWaiting
//
// Interrupt safe under these conditions: one core; the tick interrupts the session, never the
// reverse. The tick takes only complete values and never waits. Cost of each function: constant.
//
// Loop and memory annotations: docs/BOUND.md.
// memory: RAM

#include <cstdint>
#include <span>

#include "tactree/hal/board.hpp"

namespace tactree::session {

/// One value from the session to the tick.
template <class T>
class Box {
 public:
  [[nodiscard]] bool full() const { return __atomic_load_n(&full_, __ATOMIC_ACQUIRE); }
  /// Called by the session. Replaces a value that no tick has taken yet.
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

/// Status of a tick for a session.
struct TickReport {
  core::Status status{};
  std::uint32_t time_us = 0;
  bool telemetry = false;  ///< due by the subscription
  bool requested = false;  ///< the tick began after request_report()
};

class TickMailbox {
 public:
  /// Reports that wait for the session: it may be away for four ticks, 1 ms at 4 kHz, before a
  /// subscribed report is dropped. A power of two: the index wraps at 2^32.
  static constexpr std::uint32_t kWaiting = 4;

  // ---- in the tick: Link::receive() and Link::send()

  [[nodiscard]] hal::LinkInput receive() noexcept {
    hal::LinkInput input;
    take_command(input);
    if (sign_.full()) {
      input.alive = true;
      input.age_ticks = sign_.value();
      sign_.clear();
    }
    if (body_.full()) {
      input.bodies = std::span(&body_.value(), 1);  // no put() before the tick ends
      body_.clear();
    }
    if (force_.full()) {
      input.added_force = force_.value();
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
      push(status, time_us, due, asked);
    }
  }

  // ---- in the session

  /// Posts a stop. Replaces a posted command that no tick has taken yet.
  void post_stop() {
    command_.clear();
    __atomic_store_n(&stop_, true, __ATOMIC_RELEASE);
  }
  /// Returns false if the preceding command has not been taken yet.
  [[nodiscard]] bool post_command(core::Command command) {
    if (stop_ || command_.full()) {
      return false;
    }
    command_.put(command);
    return true;
  }
  /// Returns false if an update of another body has not been taken yet. Replaces one of the same
  /// body.
  [[nodiscard]] bool post_body(const hal::BodyUpdate& update) {
    if (body_.full() && body_.value().body != update.body) {
      return false;
    }
    body_.put(update);
    return true;
  }
  void post_force(const core::AddedForce& force) { force_.put(force); }
  void post_sign_of_life(std::uint16_t age_ticks) { sign_.put(age_ticks); }
  void set_storage_busy(bool busy) { __atomic_store_n(&storage_busy_, busy, __ATOMIC_RELEASE); }

  /// Requests the report of a tick that begins after this call.
  void request_report() { __atomic_store_n(&asked_, true, __ATOMIC_RELEASE); }
  /// Requests a report every `decimation` ticks; 0 requests none.
  void subscribe(std::uint32_t decimation) {
    __atomic_store_n(&decimation_, decimation, __ATOMIC_RELEASE);
    dropped_ = 0;
  }
  /// Returns the oldest report, or nullptr if there is none.
  [[nodiscard]] const TickReport* front() const {
    return __atomic_load_n(&written_, __ATOMIC_ACQUIRE) == read_ ? nullptr
                                                                 : &ring_[read_ % kWaiting];
  }
  void pop() { __atomic_store_n(&read_, read_ + 1U, __ATOMIC_RELEASE); }
  /// Number of subscribed reports that were dropped since subscribe() for lack of room.
  [[nodiscard]] std::uint32_t dropped() const { return dropped_; }
  void count_dropped() { ++dropped_; }

 private:
  void take_command(hal::LinkInput& input) {
    if (stop_) {
      input.command = core::Command::kStop;
      stop_ = false;
    } else if (command_.full()) {
      input.command = command_.value();
      command_.clear();
    }
  }

  // Writes the report in place, because a copy takes some 600 cycles on a Cortex-M4.
  void push(const core::Status& status, std::uint32_t time_us, bool due, bool asked) {
    if (written_ - __atomic_load_n(&read_, __ATOMIC_ACQUIRE) == kWaiting) {
      dropped_ += due ? 1U : 0U;
      return;
    }
    TickReport& report = ring_[written_ % kWaiting];
    report.status = status;
    report.time_us = time_us;
    report.telemetry = due;
    report.requested = asked;
    asked_ = false;
    __atomic_store_n(&written_, written_ + 1U, __ATOMIC_RELEASE);
  }

  Box<core::Command> command_{};
  Box<hal::BodyUpdate> body_{};
  Box<core::AddedForce> force_{};
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

/// The Link of a board whose only application is a session.
template <class Ticker>
struct MailboxLink {
  TickMailbox& mailbox;
  Ticker& ticker;
  [[nodiscard]] hal::LinkInput receive() noexcept { return mailbox.receive(); }
  void send(const core::Status& status) noexcept {
    mailbox.send(status, ticker.now_us());  // memory: flash (a register may be as slow)
  }
};

}  // namespace tactree::session
