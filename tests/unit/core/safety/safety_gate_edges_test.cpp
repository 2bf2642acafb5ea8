// Edges of the gate: each limit from both sides, each input alone.

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <random>

#include "open_gate.hpp"

namespace tactree::test {
namespace {

using core::GateLimits;
using core::kAxes;
using core::Limit;
using core::Mat3;
using core::SafetyGate;
using core::Vec3;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kMax = std::numeric_limits<float>::max();
constexpr float kInside = 1.0F - 4e-6F;  // how far below a limit the gate aims

bool limited(const SafetyGate::Result& result, Limit limit) {
  return (result.limits & core::limit_bit(limit)) != 0U;
}

// An axis saturated by gravity does not reduce a force on the other axes.
TEST(SafetyGateEdges, KeepsOtherAxesUnderSaturation) {
  core::GateLimits limits = roomy();
  limits.force_max_N = 1000.0F;
  SafetyGate gate = ramped(limits);
  const SafetyGate::Result result = gate.command({0.0F, 1.0F, 0.0F}, kIdentity, {1e3F, 0.0F, 0.0F});
  EXPECT_GT(result.command.effort(0), 99.0F);
  EXPECT_EQ(result.command.effort(1), 1.0F);
}

struct Range {
  const char* name;
  float low;
  float high;
  std::function<float&(GateLimits&)> field;
};

TEST(SafetyGateEdges, AcceptsLimitsWithinRangeOnly) {
  std::vector<Range> ranges = {
      {"force_max_N", 0.01F, 1000.0F, [](GateLimits& l) -> float& { return l.force_max_N; }},
      {"slew_N_per_tick", 1e-4F * 8.0F, 16.0F,
       [](GateLimits& l) -> float& { return l.slew_N_per_tick; }},
      {"continuous_share", 0.05F, 1.0F, [](GateLimits& l) -> float& { return l.continuous_share; }},
      {"heat_share_per_tick", 1e-8F, 0.1F,
       [](GateLimits& l) -> float& { return l.heat_share_per_tick; }}};
  for (std::uint32_t i = 0; i < kAxes; ++i) {
    ranges.push_back(
        {"effort_max", 1e-4F, 1000.0F, [i](GateLimits& l) -> float& { return l.effort_max[i]; }});
    ranges.push_back({"effort_slew_per_tick", 1e-4F * 8.5F, 17.0F,
                      [i](GateLimits& l) -> float& { return l.effort_slew_per_tick[i]; }});
  }
  for (const Range& range : ranges) {
    const auto taken = [&](float value) {
      GateLimits limits;
      range.field(limits) = value;
      const std::string name = range.name;
      if (name == "force_max_N") {  // its slew goes with it
        limits.slew_N_per_tick = 0.25F * value;
      }
      if (name == "effort_max") {
        for (std::uint32_t i = 0; i < kAxes; ++i) {
          limits.effort_slew_per_tick[i] = 0.25F * limits.effort_max[i];
        }
      }
      SafetyGate gate;
      return gate.configure(limits);
    };
    EXPECT_TRUE(taken(range.low)) << range.name;
    EXPECT_TRUE(taken(range.high)) << range.name;
    EXPECT_FALSE(taken(std::nextafter(range.low, -1.0F))) << range.name;
    EXPECT_FALSE(taken(std::nextafter(range.high, kMax))) << range.name;
    EXPECT_FALSE(taken(kNan)) << range.name;
  }
}

TEST(SafetyGateEdges, LimitsRampTicks) {
  for (const auto& [ticks, taken] :
       {std::pair{0U, false}, {1U, false}, {2U, true}, {1000000U, true}, {1000001U, false}}) {
    GateLimits limits;
    limits.ramp_ticks = ticks;
    SafetyGate gate;
    EXPECT_EQ(gate.configure(limits), taken) << ticks;
  }
}

TEST(SafetyGateEdges, RestartsAtZeroAfterConfiguration) {
  SafetyGate gate = ramped();
  ASSERT_FALSE(gate.command({1.0F, 0.0F, 0.0F}, kIdentity).command.is_zero());
  ASSERT_TRUE(gate.configure(roomy()));
  EXPECT_TRUE(gate.command({1.0F, 0.0F, 0.0F}, kIdentity).command.is_zero());
}

TEST(SafetyGateEdges, ReportsEachNonFiniteInput) {
  for (const float bad :
       {kNan, std::numeric_limits<float>::infinity(), -std::numeric_limits<float>::infinity()}) {
    for (std::uint32_t i = 0; i < 15; ++i) {
      float in[15] = {0.5F, 0.0F, 0.0F, 1.0F, 0.0F, 0.0F, 0.0F, 1.0F,
                      0.0F, 0.0F, 0.0F, 1.0F, 0.0F, 0.0F, 0.0F};
      in[i] = bad;
      const Mat3 map{{{in[3], in[4], in[5]}, {in[6], in[7], in[8]}, {in[9], in[10], in[11]}}};
      SafetyGate gate = ramped();
      const SafetyGate::Result result =
          gate.command({in[0], in[1], in[2]}, map, {in[12], in[13], in[14]});
      EXPECT_TRUE(result.not_finite) << i;
      EXPECT_TRUE(result.command.is_zero()) << i;
      EXPECT_TRUE(limited(gate.command({}, kIdentity), Limit::kRamp)) << i;
    }
  }
}

TEST(SafetyGateEdges, ReportsOverflowingEffort) {
  SafetyGate gate = ramped();
  const SafetyGate::Result result =
      gate.command({7.0F, 0.0F, 0.0F}, {{{kMax, 0.0F, 0.0F}, {}, {}}});
  EXPECT_TRUE(result.not_finite);
  EXPECT_TRUE(result.command.is_zero());
}

TEST(SafetyGateEdges, ReportsForceAboveLimitOnly) {
  const float allowed = kInside * 8.0F;
  SafetyGate gate = ramped();
  SafetyGate::Result result = gate.command({0.0F, allowed, 0.0F}, kIdentity);
  EXPECT_EQ(result.force.y, allowed);
  EXPECT_EQ(result.limits, 0U);
  result = gate.command({0.0F, std::nextafter(allowed, 9.0F), 0.0F}, kIdentity);
  EXPECT_TRUE(limited(result, Limit::kForce));
  EXPECT_LE(result.force.y, allowed);
}

TEST(SafetyGateEdges, KeepsDirectionOfOverflowingForce) {
  SafetyGate gate = ramped();
  const Vec3 force = gate.command({kMax, -kMax, kMax}, kIdentity).force;
  EXPECT_NEAR(force.x, 8.0F / std::sqrt(3.0F), 1e-4F);
  EXPECT_EQ(force.y, -force.x);
  EXPECT_EQ(force.z, force.x);
}

TEST(SafetyGateEdges, ReportsNothingAtZeroForce) {
  GateLimits limits = roomy();
  limits.force_max_N = 0.5F;
  limits.slew_N_per_tick = 0.1F;
  EXPECT_EQ(ramped(limits).command({}, kIdentity).limits, 0U);
}

TEST(SafetyGateEdges, ReportsSlewAboveLimitOnly) {
  GateLimits limits = roomy();
  limits.slew_N_per_tick = 2.0F;
  const float allowed = kInside * 2.0F - 4e-7F * 8.0F;
  EXPECT_EQ(ramped(limits).command({allowed, 0.0F, 0.0F}, kIdentity).limits, 0U);
  const auto beyond =
      ramped(limits).command({std::nextafter(allowed, 3.0F), 0.0F, 0.0F}, kIdentity);
  EXPECT_EQ(beyond.limits, core::limit_bit(Limit::kSlew));
}

TEST(SafetyGateEdges, ReportsAllActingLimits) {
  GateLimits limits = roomy();
  limits.slew_N_per_tick = 0.1F;
  limits.ramp_ticks = 4;
  SafetyGate gate;
  ASSERT_TRUE(gate.configure(limits));
  gate.command({}, kIdentity);
  const SafetyGate::Result result = gate.command({50.0F, 0.0F, 0.0F}, kIdentity);
  EXPECT_EQ(result.limits, core::limit_bit(Limit::kRamp) | core::limit_bit(Limit::kForce) |
                               core::limit_bit(Limit::kSlew));
}

TEST(SafetyGateEdges, ReportsActingAxisLimit) {
  GateLimits clipping = roomy();
  clipping.effort_max[1] = 3.0F;
  clipping.effort_slew_per_tick[1] = 6.0F;
  const auto clipped = ramped(clipping).command({}, kIdentity, {0.0F, 4.0F, 0.0F});
  EXPECT_EQ(clipped.limits, core::limit_bit(Limit::kAxis));
  GateLimits slow = roomy();
  slow.effort_slew_per_tick[2] = 0.5F;
  const auto slewed = ramped(slow).command({0.0F, 0.0F, 2.0F}, kIdentity);
  EXPECT_EQ(slewed.limits, core::limit_bit(Limit::kAxis));
}

// The smallest slew is of the order of the rounding of the largest force: tests the margin.
TEST(SafetyGateEdges, KeepsSmallestSlewLimit) {
  GateLimits limits;
  limits.slew_N_per_tick = 1e-4F * limits.force_max_N;
  limits.heat_share_per_tick = 1e-8F;  // cold motors: their peak is not in the way
  for (std::uint32_t i = 0; i < kAxes; ++i) {
    limits.effort_slew_per_tick[i] = 1e-4F * limits.effort_max[i];
  }
  limits.ramp_ticks = 2;
  SafetyGate gate = ramped(limits);
  std::mt19937 random(4);
  std::uniform_real_distribution<float> unit(-1.0F, 1.0F);
  Vec3 target{};
  double last[kAxes] = {};
  double excess = -1.0;
  for (int tick = 0; tick < 200000; ++tick) {
    if (tick % 20000 == 0) {
      target = {8.0F * unit(random), 8.0F * unit(random), 8.0F * unit(random)};
    }
    const SafetyGate::Result result = gate.command(target, kIdentity);
    double step = 0.0;
    for (std::uint32_t i = 0; i < kAxes; ++i) {
      const double now = static_cast<double>(result.command.effort(i));
      excess = std::max(
          excess, std::abs(now - last[i]) - static_cast<double>(limits.effort_slew_per_tick[i]));
      step += (now - last[i]) * (now - last[i]);
      last[i] = now;
    }
    excess = std::max(excess, std::sqrt(step) - static_cast<double>(limits.slew_N_per_tick));
  }
  EXPECT_LE(excess, 0.0);
}

// One axis at a time: tests its own margin.
TEST(SafetyGateEdges, KeepsSmallestAxisSlewLimit) {
  GateLimits limits = roomy();
  limits.effort_max[0] = 8.0F;
  limits.effort_slew_per_tick[0] = 1e-4F * 8.0F;
  SafetyGate gate = ramped(limits);
  double last = 0.0;
  for (int tick = 0; tick < 30000; ++tick) {
    const float target = tick % 20000 < 10000 ? 7.9F : -7.7F;
    const double now =
        static_cast<double>(gate.command({target, 0.0F, 0.0F}, kIdentity).command.effort(0));
    ASSERT_LE(std::abs(now - last), static_cast<double>(limits.effort_slew_per_tick[0])) << tick;
    last = now;
  }
}

TEST(SafetyGateEdges, HeatsEachAxisSeparately) {
  for (std::uint32_t axis = 0; axis < kAxes; ++axis) {
    SafetyGate gate = ramped();
    const float one[kAxes] = {axis == 0 ? 1.0F : 0.0F, axis == 1 ? 1.0F : 0.0F,
                              axis == 2 ? 1.0F : 0.0F};
    gate.command({one[0], one[1], one[2]}, kIdentity);
    for (std::uint32_t other = 0; other < kAxes; ++other) {
      EXPECT_EQ(gate.heat().heat(other) > 0.0F, other == axis);
    }
  }
}

}  // namespace
}  // namespace tactree::test
