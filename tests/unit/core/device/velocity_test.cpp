// The velocity of a quantised position.

#include "tactree/core/device/velocity.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace tactree::test {
namespace {

constexpr double kQuantum = 30e-6;  // m
constexpr double kTick = 1e-3;      // s

core::Vec3 quantised(double x) {
  return {static_cast<float>(std::floor(x / kQuantum) * kQuantum), 0.0F, 0.0F};
}

core::VelocityEstimator estimator() {
  core::VelocityEstimator e;
  const auto quantum = static_cast<float>(kQuantum);
  e.configure(static_cast<float>(kTick), {quantum, quantum, quantum}, 200.0F);
  return e;
}

TEST(Velocity, BeatsDifferenceAtSteadySpeed) {
  for (const double speed : {0.003, 0.01, 0.05, 0.3, 1.0}) {
    core::VelocityEstimator e = estimator();
    double worst = 0.0;
    double worst_difference = 0.0;
    core::Vec3 last = quantised(0.0);
    for (int tick = 0; tick < 400; ++tick) {
      const core::Vec3 x = quantised(speed * kTick * tick);
      const double v = static_cast<double>(e.update(x).x);
      if (tick > 60) {
        worst = std::max(worst, std::abs(v - speed));
        worst_difference =
            std::max(worst_difference, std::abs(static_cast<double>(x.x - last.x) / kTick - speed));
      }
      last = x;
    }
    EXPECT_LE(worst, 0.0045) << speed;
    if (speed < 0.02) {
      EXPECT_GE(worst_difference, 0.015);
    }
  }
}

TEST(Velocity, DetectsStopWithinTenTicks) {
  core::VelocityEstimator e = estimator();
  for (int tick = 0; tick < 100; ++tick) {
    e.update(quantised(0.3 * kTick * tick));
  }
  for (int tick = 0; tick < 10; ++tick) {
    e.update(quantised(0.3 * kTick * 99));
  }
  EXPECT_LE(std::abs(e.velocity().x), 0.01F);
}

TEST(Velocity, IgnoresJitterOfOneCount) {
  core::VelocityEstimator e = estimator();
  double worst = 0.0;
  for (int tick = 0; tick < 300; ++tick) {
    const double jitter = (tick * 7 % 5) < 2 ? 0.0 : 0.9 * kQuantum;
    const double v = static_cast<double>(e.update(quantised(10.5 * kQuantum + jitter)).x);
    worst = tick > 30 ? std::max(worst, std::abs(v)) : worst;
  }
  EXPECT_LE(worst, 0.003);
}

TEST(Velocity, ClearsOnReset) {
  core::VelocityEstimator e = estimator();
  e.update(quantised(0.0));
  e.update(quantised(0.001));
  EXPECT_GT(e.velocity().x, 0.1F);
  e.reset();
  EXPECT_EQ(e.velocity().x, 0.0F);
  EXPECT_EQ(e.update(quantised(0.5)).x, 0.0F);  // no jump from before
}

}  // namespace
}  // namespace tactree::test
