#pragma once
// Test of a board against the contracts of board.hpp. A port calls run_conformance() on its
// hardware and prints the report. All commands are zero, so nothing moves. Duration: about 1000
// ticks.
// Loop and memory annotations: docs/BOUND.md.

#include <cstddef>
#include <cstdint>
#include <span>

#include "tactree/core/math/crc32.hpp"
#include "tactree/core/safety/safety_gate.hpp"
#include "tactree/hal/board.hpp"

namespace tactree::hal {

/// Properties of the board under test. Do not touch the device during the test.
struct ConformanceSetup {
  std::uint32_t period_us = 1000;           ///< tick period
  std::uint32_t enable_timeout_ticks = 50;  ///< limit for the read-back
  std::int32_t count_noise = 2;             ///< maximum deviation of an axis at rest, counts
};

struct ConformanceReport {
  /// Failures with a sentence; further ones are only counted, because a board has no heap.
  static constexpr std::uint32_t kMaxFailures = 16;
  std::uint32_t checks = 0;
  std::uint32_t failures = 0;
  const char* failed[kMaxFailures] = {};  ///< one sentence per failure

  [[nodiscard]] bool passed() const { return checks > 0U && failures == 0U; }

  void check(bool good, const char* sentence) {
    ++checks;
    if (good) {
      return;
    }
    if (failures < kMaxFailures) {
      failed[failures] = sentence;
    }
    ++failures;
  }
};

namespace conformance {

/// Ticks per check: the tolerance of the clock, 2 %, is then two ticks, more than the jitter of the
/// first and the last.
inline constexpr std::uint32_t kTicks = 100;

/// Returns the ticks until the read-back agrees; more than `limit` means a timeout.
template <Board B>
std::uint32_t ticks_to_follow(B& board, bool on, std::uint32_t limit) {
  board.enable_line().set(on);
  std::uint32_t ticks = 0;
  while (board.enable_line().read_back() != on && ticks <= limit) {  // bound: limit
    (void)board.ticker().wait();
    ++ticks;
  }
  return ticks;
}

template <Board B>
void check_ticker(B& board, const ConformanceSetup& setup, ConformanceReport& report) {
  (void)board.ticker().wait();
  const std::uint32_t begin = board.ticker().now_us();
  std::uint32_t overruns = 0;
  bool forward = true;
  std::uint32_t last = begin;
  for (std::uint32_t i = 0; i < kTicks; ++i) {  // bound: kTicks
    overruns += board.ticker().wait().overruns;
    const std::uint32_t now = board.ticker().now_us();
    forward = forward && now - last < 0x80000000U;
    last = now;
  }
  const std::uint32_t expected = kTicks * setup.period_us;
  const std::uint32_t elapsed = last - begin;
  report.check(forward, "the clock ran backwards");
  report.check(overruns == 0U, "an empty loop missed a deadline");
  report.check(elapsed >= expected - expected / 50U && elapsed <= expected + expected / 50U,
               "the time of 100 ticks differs from 100 periods by more than 2 %");
}

template <Board B>
void check_encoders(B& board, const ConformanceSetup& setup, ConformanceReport& report) {
  const core::EncoderReading first = board.encoders().read();
  bool valid = true;
  bool still = true;
  for (std::uint32_t i = 0; i < kTicks; ++i) {  // bound: kTicks
    (void)board.ticker().wait();
    const core::EncoderReading reading = board.encoders().read();
    for (std::uint32_t axis = 0; axis < core::kAxes; ++axis) {  // bound: kAxes
      const auto moved =
          static_cast<std::int32_t>(static_cast<std::uint32_t>(reading.counts[axis]) -
                                    static_cast<std::uint32_t>(first.counts[axis]));
      valid = valid && reading.valid[axis];
      still = still && moved <= setup.count_noise && moved >= -setup.count_noise;
    }
  }
  report.check(valid, "an encoder at rest is not valid");
  report.check(still, "an encoder at rest changes its count");
}

template <Board B>
void check_enable_line(B& board, const ConformanceSetup& setup, ConformanceReport& report) {
  const std::uint32_t limit = setup.enable_timeout_ticks;
  report.check(!board.enable_line().read_back(), "the enable line is on at the start");
  report.check(ticks_to_follow(board, true, limit) <= limit,
               "the read-back does not follow when the enable line goes on");
  report.check(ticks_to_follow(board, false, limit) <= limit,
               "the read-back does not follow when the enable line goes off");
}

template <Board B>
void check_motors(B& board, ConformanceReport& report) {
  core::SafetyGate gate;
  bool healthy = true;
  for (std::uint32_t i = 0; i < kTicks; ++i) {  // bound: kTicks
    (void)board.ticker().wait();
    board.motors().write(gate.release().command);
    healthy = healthy && board.motors().healthy();
  }
  report.check(healthy, "the motor bank fails on commands of zero");
}

template <Board B>
void check_inputs(B& board, ConformanceReport& report) {
  report.check(!board.safety_inputs().emergency_stop(), "the emergency stop reads as pressed");
  report.check(!board.safety_inputs().dead_man(), "the dead-man control reads as held");
  core::Command command = core::Command::kNone;
  bool moved = false;
  for (std::uint32_t i = 0; i < kTicks; ++i) {  // bound: kTicks
    (void)board.ticker().wait();
    board.link().send(core::Status{});
    const LinkInput input = board.link().receive();
    command = input.command == core::Command::kNone ? command : input.command;
    moved = moved || !input.bodies.empty();
  }
  report.check(command == core::Command::kNone, "the link returns an unsent command");
  report.check(!moved, "the link returns unsent body updates");
}

/// Computes the checksum in at most 256 slices with a tick after each, so the watchdog of the board
/// is served.
template <Board B>
std::uint32_t checksum_over_ticks(B& board, std::span<const std::byte> bytes) {
  const std::size_t slice = bytes.size() / 256U + 1U;
  core::Crc32 checksum;
  while (!bytes.empty()) {  // bound: bytes
    const std::size_t size = slice < bytes.size() ? slice : bytes.size();
    checksum.update(bytes.first(size));
    bytes = bytes.subspan(size);
    (void)board.ticker().wait();
  }
  return checksum.value();
}

template <Board B>
void check_storage(B& board, ConformanceReport& report) {
  const std::span<const std::byte> bytes = board.storage().active();
  const auto address = reinterpret_cast<std::uintptr_t>(bytes.data());
  report.check(address % 4U == 0U, "the model does not start on a 4-byte boundary");
  const std::uint32_t before = checksum_over_ticks(board, bytes);
  const std::span<const std::byte> again = board.storage().active();
  report.check(again.data() == bytes.data() && again.size() == bytes.size(),
               "the model moved or changed its size");
  report.check(checksum_over_ticks(board, again) == before, "the bytes of the model changed");
}

}  // namespace conformance

/// Runs every check. Precondition: emergency stop and dead-man control released, no host connected,
/// device at rest, motors off. Call it from the context of the control loop, instead of the loop.
template <Board B>
[[nodiscard]] ConformanceReport run_conformance(B& board, const ConformanceSetup& setup = {}) {
  ConformanceReport report;
  conformance::check_ticker(board, setup, report);
  conformance::check_encoders(board, setup, report);
  conformance::check_motors(board, report);
  conformance::check_enable_line(board, setup, report);
  conformance::check_inputs(board, report);
  conformance::check_storage(board, report);
  return report;
}

}  // namespace tactree::hal
