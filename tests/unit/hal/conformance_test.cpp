// The simulated board satisfies the contracts; a board that violates one is detected.

#include "tactree/hal/conformance.hpp"

#include <gtest/gtest.h>

#include <array>
#include <string>

#include "tactree/hal/sim/board.hpp"

namespace tactree::test {
namespace {

using hal::sim::BoardParameters;
using hal::sim::SimBoard;

alignas(4) const std::array<std::byte, 64> kBytes{};

/// The first readings precede the device.
void power_up(SimBoard& board) {
  for (std::uint32_t i = 0; i <= hal::sim::kMaxLatencyTicks; ++i) {
    board.sample({0.0, 0.0, 0.0});
  }
}

std::string failures(const hal::ConformanceReport& report) {
  std::string all;
  for (std::uint32_t i = 0; i < report.failures; ++i) {
    all += std::string(report.failed[i]) + "; ";
  }
  return all;
}

TEST(Conformance, PassesSimulatedBoard) {
  SimBoard board({}, kBytes);
  power_up(board);
  const hal::ConformanceReport report = hal::run_conformance(board);
  EXPECT_TRUE(report.passed()) << failures(report);
  EXPECT_GE(report.checks, 14U);
}

TEST(Conformance, PassesDelayedBoardWithoutModel) {
  BoardParameters parameters;
  parameters.enable_delay_ticks = 40;
  parameters.encoders.latency_ticks = 3;
  parameters.motors.latency_ticks = 3;
  SimBoard board(parameters, {});
  power_up(board);
  const hal::ConformanceReport report = hal::run_conformance(board);
  EXPECT_TRUE(report.passed()) << failures(report);
}

/// Runs the checks on a board with one fault; returns the sentences of all failures.
template <class Break>
std::string failures_when(const Break& break_it, const BoardParameters& parameters = {}) {
  SimBoard board(parameters, kBytes);
  power_up(board);
  break_it(board);
  const hal::ConformanceReport report = hal::run_conformance(board);
  EXPECT_FALSE(report.passed());
  return failures(report);
}

TEST(Conformance, DetectsFaultyBoards) {
  EXPECT_EQ(failures_when([](SimBoard& b) { b.enable_line().stick(true); }),
            "the enable line is on at the start; the read-back does not follow when the enable "
            "line goes off; ");
  EXPECT_EQ(failures_when([](SimBoard& b) { b.enable_line().stick(false); }),
            "the read-back does not follow when the enable line goes on; ");
  EXPECT_EQ(failures_when([](SimBoard& b) {
              b.encoders().inject(1, hal::sim::EncoderFault::kDisconnected);
              b.sample({0.0, 0.0, 0.0});
            }),
            "an encoder at rest is not valid; ");
  EXPECT_EQ(failures_when([](SimBoard& b) { b.motors().set_healthy(false); }),
            "the motor bank fails on commands of zero; ");
  EXPECT_EQ(failures_when([](SimBoard& b) { b.safety_inputs().press_emergency_stop(true); }),
            "the emergency stop reads as pressed; ");
  EXPECT_EQ(failures_when([](SimBoard& b) { b.safety_inputs().hold_dead_man(true); }),
            "the dead-man control reads as held; ");
  EXPECT_EQ(failures_when([](SimBoard& b) { b.link().post(core::Command::kArm); }),
            "the link returns an unsent command; ");
  EXPECT_EQ(failures_when([](SimBoard& b) {
              b.link().post(core::Command::kNone);
              b.link().attach(hal::BodyUpdate{.body = 0});
            }),
            "the link returns unsent body updates; ");
  EXPECT_EQ(failures_when([](SimBoard&) {},
                          [] {
                            BoardParameters slow;
                            slow.period_us = 1100;
                            return slow;
                          }()),
            "the time of 100 ticks differs from 100 periods by more than 2 %; ");
}

/// A board whose encoders count by themselves, whose clock misses deadlines and whose model moves.
class RestlessBoard {
 public:
  struct Encoders {
    core::EncoderReading reading{{0, 0, 0}, {true, true, true}};
    core::EncoderReading read() noexcept {
      ++reading.counts[0];
      return reading;
    }
  };
  struct Ticker {
    std::uint32_t now = 0xFFFFFF00U;
    std::uint32_t ticks = 0;
    hal::Tick wait() noexcept {
      now += 1000U;
      return {++ticks == 7U ? 1U : 0U};
    }
    std::uint32_t now_us() noexcept { return now; }
  };
  struct Storage {
    mutable std::size_t size = 4;
    std::span<const std::byte> active() const noexcept {
      return std::span(kBytes).subspan(1, ++size);
    }
  };

  Encoders& encoders() noexcept { return encoders_; }
  hal::sim::SimMotorBank& motors() noexcept { return inner_.motors(); }
  hal::sim::SimEnableLine& enable_line() noexcept { return inner_.enable_line(); }
  hal::sim::SimSafetyInputs& safety_inputs() noexcept { return inner_.safety_inputs(); }
  Ticker& ticker() noexcept { return ticker_; }
  hal::sim::SimLink& link() noexcept { return inner_.link(); }
  Storage& storage() noexcept { return storage_; }

 private:
  BoardParameters no_delay_{{}, {}, 1000, 0};
  SimBoard inner_{no_delay_, {}};
  Encoders encoders_;
  Ticker ticker_;
  Storage storage_;
};

TEST(Conformance, DetectsRestlessBoard) {
  RestlessBoard board;
  const hal::ConformanceReport report = hal::run_conformance(board);
  EXPECT_FALSE(report.passed());
  const std::string all = failures(report);
  EXPECT_NE(all.find("an encoder at rest changes its count"), std::string::npos) << all;
  EXPECT_NE(all.find("an empty loop missed a deadline"), std::string::npos) << all;
  EXPECT_NE(all.find("the model does not start on a 4-byte boundary"), std::string::npos) << all;
  EXPECT_NE(all.find("the model moved or changed its size"), std::string::npos) << all;
  EXPECT_EQ(all.find("the clock ran backwards"), std::string::npos) << all;  // it only wraps
}

/// Not a board: a part is missing, or throws.
struct Throwing {
  core::EncoderReading read();
};
static_assert(!hal::EncoderBank<Throwing>);
static_assert(!hal::Board<Throwing>);
static_assert(hal::Board<RestlessBoard>);

}  // namespace
}  // namespace tactree::test
