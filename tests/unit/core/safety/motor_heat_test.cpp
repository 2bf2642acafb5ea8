// Thermal model of the windings, alone and in the gate.

#include "tactree/core/safety/motor_heat.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "open_gate.hpp"

namespace tactree::test {
namespace {

using core::MotorHeat;

constexpr float kContinuous = 0.35F;
constexpr float kShare = 1e-3F;

MotorHeat motors() {
  MotorHeat heat;
  heat.configure(kContinuous, kShare);
  return heat;
}

TEST(MotorHeat, AllowsContinuousEffortIndefinitely) {
  MotorHeat heat = motors();
  for (int i = 0; i < 20000; ++i) {
    heat.add(0, kContinuous);
  }
  EXPECT_NEAR(heat.heat(0), 1.0F, 1e-3F);
  EXPECT_NEAR(heat.allowed(0), kContinuous, 0.02F);
  EXPECT_EQ(heat.allowed(1), 1.0F);  // another motor
}

TEST(MotorHeat, AllowsPeakForCalculatedTime) {
  MotorHeat heat = motors();
  int ticks = 0;
  while (heat.allowed(2) >= 1.0F && ticks < 100000) {
    heat.add(2, -1.0F);
    ++ticks;
  }
  const double expected = -1000.0 * std::log(1.0 - 0.8 * 0.35 * 0.35);
  EXPECT_NEAR(ticks, expected, 2.0);
}

TEST(MotorHeat, CoolsAtRest) {
  MotorHeat heat = motors();
  for (int i = 0; i < 200; ++i) {
    heat.add(0, 1.0F);
  }
  const float warm = heat.heat(0);
  for (int i = 0; i < 1000; ++i) {
    heat.add(0, 0.0F);
  }
  EXPECT_NEAR(heat.heat(0), warm * std::exp(-1.0F), 0.01F);
}

core::GateLimits quick_to_warm() {
  core::GateLimits limits;
  limits.ramp_ticks = 2;
  limits.heat_share_per_tick = kShare;
  return limits;
}

TEST(MotorHeat, LimitsGateToContinuousEffort) {
  core::SafetyGate gate;
  const core::GateLimits limits = quick_to_warm();
  ASSERT_TRUE(gate.configure(limits));
  core::LimitMask seen = 0;
  float last = 0.0F;
  for (int i = 0; i < 20000; ++i) {
    const core::SafetyGate::Result r = gate.command({0.0F, 0.0F, 8.0F}, kIdentity);
    seen = r.limits;
    last = r.command.effort(2);
    ASSERT_LE(gate.heat().heat(2), 1.01F);
  }
  EXPECT_NE(seen & core::limit_bit(core::Limit::kThermal), 0U);
  EXPECT_NEAR(last, kContinuous * limits.effort_max[2], 0.1F);
}

TEST(MotorHeat, CoolsWithoutForce) {
  core::SafetyGate gate;
  ASSERT_TRUE(gate.configure(quick_to_warm()));
  for (int i = 0; i < 2000; ++i) {
    (void)gate.command({0.0F, 0.0F, 8.0F}, kIdentity);
  }
  const float warm = gate.heat().heat(2);
  for (int i = 0; i < 2000; ++i) {
    (void)gate.release();
  }
  EXPECT_LT(gate.heat().heat(2), 0.2F * warm);
}

TEST(MotorHeat, KeepsHeatAcrossConfiguration) {
  core::SafetyGate gate;
  ASSERT_TRUE(gate.configure(quick_to_warm()));
  for (int i = 0; i < 2000; ++i) {
    (void)gate.command({0.0F, 0.0F, 8.0F}, kIdentity);
  }
  const float warm = gate.heat().heat(2);
  ASSERT_TRUE(gate.configure(quick_to_warm()));
  EXPECT_GT(gate.heat().heat(2), 0.99F * warm);
}

TEST(MotorHeat, ReducesPeakLinearly) {
  core::MotorHeat heat;
  heat.configure(0.5F, 0.01F);
  float before = 1.0F;
  bool between = false;
  for (int tick = 0; tick < 1000; ++tick) {
    heat.add(0, 1.0F);
    const float warm = heat.heat(0);
    const float share = std::clamp((1.0F - warm) / 0.2F, 0.0F, 1.0F);
    EXPECT_NEAR(heat.allowed(0), 0.5F + 0.5F * share, 1e-6F) << warm;
    EXPECT_LE(heat.allowed(0), before);
    before = heat.allowed(0);
    between = between || (share > 0.4F && share < 0.6F);
  }
  EXPECT_TRUE(between);
  EXPECT_GT(heat.heat(0), 2.0F);
  EXPECT_EQ(heat.allowed(0), 0.5F);
}

}  // namespace
}  // namespace tactree::test
