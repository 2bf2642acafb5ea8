// The imperfections of the simulated board match their parameters.

#include <gtest/gtest.h>

#include <limits>

#include "open_gate.hpp"
#include "tactree/hal/sim/board.hpp"

namespace tactree::test {
namespace {

using namespace hal::sim;

TEST(DelayLine, DelaysByLatency) {
  for (const std::uint32_t latency : {0U, 1U, 5U, kMaxLatencyTicks}) {
    DelayLine<int> line(latency, -1);
    for (int i = 0; i < 200; ++i) {
      line.push(i);
      const int expected = i - static_cast<int>(latency);
      ASSERT_EQ(line.value(), expected < 0 ? -1 : expected);
    }
  }
}

TEST(SimEncoder, QuantisesDownwards) {
  EncoderParameters parameters;
  parameters.counts_per_m = 1000.0;
  SimEncoderBank bank(parameters);
  bank.sample({0.0029999, -0.0000001, 0.003});
  const core::EncoderReading reading = bank.read();
  EXPECT_EQ(reading.counts[0], 2);
  EXPECT_EQ(reading.counts[1], -1);
  EXPECT_EQ(reading.counts[2], 3);
  EXPECT_TRUE(reading.valid[0] && reading.valid[1] && reading.valid[2]);
}

TEST(SimEncoder, ReadsDelayedPositions) {
  EncoderParameters parameters;
  parameters.counts_per_m = 1000.0;
  parameters.latency_ticks = 2;
  SimEncoderBank bank(parameters);
  for (int tick = 0; tick < 10; ++tick) {
    bank.sample({tick * 1e-3 + 1e-4, 0.0, 0.0});
    EXPECT_EQ(bank.read().valid[0], tick >= 2);
    EXPECT_EQ(bank.read().counts[0], tick >= 2 ? tick - 2 : 0);
  }
}

TEST(SimEncoder, CountsAcrossOverflow) {
  EncoderParameters parameters;
  parameters.counts_per_m = 1000.0;
  parameters.start_count = 0x7FFFFFFFU;
  SimEncoderBank bank(parameters);
  bank.sample({0.0015, 0.0, 0.0});
  EXPECT_EQ(bank.read().counts[0], std::numeric_limits<std::int32_t>::min());
}

TEST(SimEncoder, InjectsFaults) {
  EncoderParameters parameters;
  parameters.counts_per_m = 1000.0;
  SimEncoderBank bank(parameters);
  bank.sample({0.0105, 0.0105, 0.0105});
  bank.inject(0, EncoderFault::kStuck);
  bank.inject(1, EncoderFault::kDisconnected);
  bank.jump(2, -100);
  bank.sample({0.0205, 0.0205, 0.0205});
  const core::EncoderReading reading = bank.read();
  EXPECT_EQ(reading.counts[0], 10);
  EXPECT_TRUE(reading.valid[0]);
  EXPECT_FALSE(reading.valid[1]);
  EXPECT_EQ(reading.counts[2], -80);
}

TEST(SimMotor, HoldsSaturatesAndNeedsPower) {
  MotorParameters parameters;
  parameters.effort_max = 2.0;
  SimMotorBank bank(parameters);
  EXPECT_EQ(bank.effort(0, true), 0.0);
  bank.write(command_of(1.5F));
  EXPECT_EQ(bank.effort(0, true), 1.5);
  EXPECT_EQ(bank.effort(0, false), 0.0);
  bank.write(command_of(-5.0F));
  EXPECT_EQ(bank.effort(0, true), -2.0);
}

TEST(SimMotor, ActsAfterItsLatency) {
  MotorParameters parameters;
  parameters.latency_ticks = 1;
  SimMotorBank bank(parameters);
  bank.write(command_of(1.0F));
  EXPECT_EQ(bank.effort(0, true), 0.0);
  bank.write(command_of(2.0F));
  EXPECT_EQ(bank.effort(0, true), 1.0);
}

TEST(SimMotor, InjectsFaults) {
  SimMotorBank bank({});
  bank.write(command_of(1.0F));
  bank.inject(0, MotorFault::kReversed);
  EXPECT_EQ(bank.effort(0, true), -1.0);
  bank.inject(0, MotorFault::kDead);
  EXPECT_EQ(bank.effort(0, true), 0.0);
  bank.inject(0, MotorFault::kNone);
  EXPECT_EQ(bank.effort(0, true), 1.0);
  bank.inject(0, MotorFault::kStuck);
  bank.write(command_of(2.0F));
  EXPECT_EQ(bank.effort(0, true), 1.0);
}

TEST(SimEnableLine, FollowsAfterItsDelay) {
  SimEnableLine line(3);
  line.set(true);
  int ticks = 0;
  while (!line.read_back() && ticks < 100) {
    line.advance();
    ++ticks;
  }
  EXPECT_EQ(ticks, 4);  // sampled at the next tick, then three on the way
}

TEST(SimTicker, CountsMissedDeadlines) {
  SimEnableLine line(0);
  SimTicker ticker(250, line);
  EXPECT_EQ(ticker.wait().overruns, 0U);
  EXPECT_EQ(ticker.now_us(), 250U);
  ticker.miss(2);
  EXPECT_EQ(ticker.wait().overruns, 2U);
  EXPECT_EQ(ticker.now_us(), 1000U);
  EXPECT_EQ(ticker.wait().overruns, 0U);
}

TEST(SimLink, ReturnsEachMessageOnce) {
  SimPanel panel(1000.0F);
  SimLink link(panel);
  EXPECT_FALSE(link.receive().alive);
  link.post(core::Command::kStop);
  const hal::LinkInput input = link.receive();
  EXPECT_TRUE(input.alive);
  EXPECT_EQ(input.command, core::Command::kStop);
  EXPECT_FALSE(link.receive().alive);
  EXPECT_EQ(link.receive().command, core::Command::kNone);
}

TEST(SimLink, DropsUpdatesOfLostMessage) {
  SimPanel panel(1000.0F);
  SimLink link(panel);
  const hal::BodyUpdate gone{.body = 3, .enabled = false};
  link.post(core::Command::kStop);
  link.attach(gone);
  const hal::LinkInput input = link.receive();
  EXPECT_EQ(input.command, core::Command::kStop);
  ASSERT_EQ(input.bodies.size(), 1U);
  EXPECT_EQ(input.bodies[0].body, 3U);
  EXPECT_FALSE(input.bodies[0].enabled);
  EXPECT_TRUE(link.receive().bodies.empty());
  link.post(core::Command::kStop);
  link.cut();
  link.attach(gone);
  const hal::LinkInput nothing = link.receive();
  EXPECT_FALSE(nothing.alive);
  EXPECT_TRUE(nothing.bodies.empty());
}

}  // namespace
}  // namespace tactree::test
