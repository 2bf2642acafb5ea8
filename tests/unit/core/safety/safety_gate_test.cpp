// The gate in front of the motors: for every input a finite command within the limits.

#include "tactree/core/safety/safety_gate.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <random>
#include <type_traits>

#include "odd_floats.hpp"
#include "open_gate.hpp"

namespace tactree::test {
namespace {

using core::Mat3;
using core::SafetyGate;
using core::Vec3;

constexpr float kInfinity = std::numeric_limits<float>::infinity();

static_assert(!std::is_default_constructible_v<core::MotorCommand>);
static_assert(!std::is_constructible_v<core::MotorCommand, float>);
static_assert(!std::is_constructible_v<core::MotorCommand, float, float, float>);
static_assert(!std::is_aggregate_v<core::MotorCommand>);
static_assert(!std::is_default_constructible_v<SafetyGate::Result>);

double norm(double x, double y, double z) { return std::sqrt(x * x + y * y + z * z); }

/// Checks a gate's commands and counts violations. Efforts equal forces (identity map).
class Watch {
 public:
  explicit Watch(const core::GateLimits& limits) : limits_(limits) {}

  void see(const SafetyGate::Result& result) {
    double now[core::kAxes];
    for (std::uint32_t i = 0; i < core::kAxes; ++i) {
      const float effort = result.command.effort(i);
      broken_ += std::isfinite(effort) ? 0U : 1U;
      now[i] = static_cast<double>(effort);
      broken_ += std::abs(now[i]) <= static_cast<double>(limits_.effort_max[i]) ? 0U : 1U;
      broken_ += std::abs(now[i] - last_[i]) <= static_cast<double>(limits_.effort_slew_per_tick[i])
                     ? 0U
                     : 1U;
    }
    broken_ += norm(now[0], now[1], now[2]) <= static_cast<double>(limits_.force_max_N) ? 0U : 1U;
    const double step = norm(now[0] - last_[0], now[1] - last_[1], now[2] - last_[2]);
    broken_ += step <= static_cast<double>(limits_.slew_N_per_tick) ? 0U : 1U;
    largest_ = std::max(largest_, norm(now[0], now[1], now[2]));
    largest_step_ = std::max(largest_step_, step);
    std::copy(now, now + core::kAxes, last_);
  }
  /// Force off: no slew applies.
  void see_zero(const SafetyGate::Result& result) {
    broken_ += result.command.is_zero() ? 0U : 1U;
    std::fill(last_, last_ + core::kAxes, 0.0);
  }

  [[nodiscard]] std::uint64_t broken() const { return broken_; }
  [[nodiscard]] double largest() const { return largest_; }
  [[nodiscard]] double largest_step() const { return largest_step_; }

 private:
  core::GateLimits limits_;
  double last_[core::kAxes] = {0.0, 0.0, 0.0};
  double largest_ = 0.0;
  double largest_step_ = 0.0;
  std::uint64_t broken_ = 0;
};

core::GateLimits short_ramp() {
  core::GateLimits limits;
  limits.force_max_N = 7.3F;
  limits.slew_N_per_tick = 1.7F;
  limits.ramp_ticks = 5;
  return limits;
}

float random_bits(std::mt19937& random) {
  return std::bit_cast<float>(static_cast<std::uint32_t>(random()));
}

TEST(SafetyGate, KeepsLimitsForRandomBits) {
  SafetyGate gate;
  ASSERT_TRUE(gate.configure(short_ramp()));
  Watch watch(short_ramp());
  std::mt19937 random(1);
  std::uint64_t not_finite = 0;
  for (std::uint32_t i = 0; i < 10'000'000U; ++i) {
    const Vec3 force{random_bits(random), random_bits(random), random_bits(random)};
    const SafetyGate::Result result = gate.command(force, kIdentity);
    not_finite += result.not_finite ? 1U : 0U;
    if (result.not_finite) {
      watch.see_zero(result);
    } else {
      watch.see(result);
    }
  }
  EXPECT_EQ(watch.broken(), 0U);
  EXPECT_GT(not_finite, 10'000U);
  // The limits were reached: a limit that is too low would fail as well.
  EXPECT_GT(watch.largest(), 0.9999 * 7.3);
  EXPECT_GT(watch.largest_step(), 0.9999 * 1.7);
}

TEST(SafetyGate, KeepsLimitsForOrdinaryForces) {
  SafetyGate gate;
  ASSERT_TRUE(gate.configure(short_ramp()));
  Watch watch(short_ramp());
  std::mt19937 random(2);
  std::normal_distribution<float> newton(0.0F, 5.0F);
  for (std::uint32_t i = 0; i < 1'000'000U; ++i) {
    const bool active = random() % 50U != 0U;
    if (active) {
      watch.see(gate.command({newton(random), newton(random), newton(random)}, kIdentity));
    } else {
      watch.see_zero(gate.release());
    }
  }
  EXPECT_EQ(watch.broken(), 0U);
  EXPECT_GT(watch.largest(), 0.999 * 7.3);
}

TEST(SafetyGate, KeepsLimitsForUnusualFloats) {
  const core::GateLimits limits = short_ramp();
  Watch watch(limits);
  SafetyGate gate;
  ASSERT_TRUE(gate.configure(limits));
  for (const float x : kOddFloats) {
    for (const float y : kOddFloats) {
      for (const float z : kOddFloats) {
        for (int tick = 0; tick < 3; ++tick) {
          const SafetyGate::Result result = gate.command({x, y, z}, kIdentity);
          const bool finite = std::isfinite(x) && std::isfinite(y) && std::isfinite(z);
          EXPECT_EQ(result.not_finite, !finite);
          finite ? watch.see(result) : watch.see_zero(result);
        }
      }
    }
  }
  EXPECT_EQ(watch.broken(), 0U);
}

TEST(SafetyGate, KeepsLimitsForUnusualMaps) {
  const core::GateLimits limits = short_ramp();
  SafetyGate gate;
  ASSERT_TRUE(gate.configure(limits));
  for (std::uint32_t entry = 0; entry < 9; ++entry) {
    for (const float odd : kOddFloats) {
      for (const float force : kOddFloats) {
        Mat3 map = kIdentity;
        Vec3& row = map.row[entry / 3];
        (entry % 3 == 0 ? row.x : entry % 3 == 1 ? row.y : row.z) = odd;
        for (int tick = 0; tick < 4; ++tick) {
          const SafetyGate::Result result = gate.command({force, 1.0F, -2.0F}, map);
          for (std::uint32_t axis = 0; axis < core::kAxes; ++axis) {
            ASSERT_TRUE(std::abs(result.command.effort(axis)) <= limits.effort_max[axis]);
          }
          const bool finite = std::isfinite(odd) && std::isfinite(force);
          ASSERT_TRUE(finite || result.not_finite);
          ASSERT_TRUE(finite || result.command.is_zero());
        }
      }
    }
  }
}

TEST(SafetyGate, RampsFromExactlyZero) {
  core::GateLimits limits = short_ramp();
  limits.ramp_ticks = 100;
  limits.slew_N_per_tick = 10.0F;
  SafetyGate gate;
  ASSERT_TRUE(gate.configure(limits));
  for (int session = 0; session < 3; ++session) {
    for (int tick = 0; tick < 150; ++tick) {
      const SafetyGate::Result result = gate.command({0.0F, 0.0F, 2.0F}, kIdentity);
      const float expected = 2.0F * static_cast<float>(std::min(tick, 100)) / 100.0F;
      ASSERT_NEAR(result.command.effort(2), expected, 1e-5F) << tick;
      ASSERT_EQ((result.limits & core::limit_bit(core::Limit::kRamp)) != 0U, tick < 100);
      if (tick == 0) {
        ASSERT_TRUE(result.command.is_zero());
      }
    }
    ASSERT_TRUE(gate.release().command.is_zero());
  }
}

TEST(SafetyGate, PassesForceWithinLimitsUnchanged) {
  SafetyGate gate;
  ASSERT_TRUE(gate.configure(short_ramp()));
  SafetyGate::Result result = gate.release();
  for (int tick = 0; tick < 10; ++tick) {
    result = gate.command({1.0F, -0.5F, 0.25F}, kIdentity);
  }
  EXPECT_EQ(result.command.effort(0), 1.0F);
  EXPECT_EQ(result.command.effort(1), -0.5F);
  EXPECT_EQ(result.command.effort(2), 0.25F);
  EXPECT_EQ(result.limits, 0U);
  EXPECT_EQ(result.force, (Vec3{1.0F, -0.5F, 0.25F}));
}

TEST(SafetyGate, KeepsDirectionAboveForceLimit) {
  SafetyGate gate;
  ASSERT_TRUE(gate.configure(short_ramp()));
  SafetyGate::Result result = gate.release();
  for (int tick = 0; tick < 50; ++tick) {
    result = gate.command({30.0F, 40.0F, 0.0F}, kIdentity);
  }
  EXPECT_NEAR(result.command.effort(0), 0.6F * 7.3F, 1e-3F);
  EXPECT_NEAR(result.command.effort(1), 0.8F * 7.3F, 1e-3F);
  EXPECT_EQ(result.limits, core::limit_bit(core::Limit::kForce));
}

TEST(SafetyGate, ScalesAllAxesTogether) {
  core::GateLimits limits = short_ramp();
  limits.effort_max[0] = 1.0F;
  SafetyGate gate;
  ASSERT_TRUE(gate.configure(limits));
  SafetyGate::Result result = gate.release();
  for (int tick = 0; tick < 50; ++tick) {
    result = gate.command({4.0F, 2.0F, 0.0F}, kIdentity);
  }
  EXPECT_NEAR(result.command.effort(0), 1.0F, 1e-4F);
  EXPECT_NEAR(result.command.effort(1), 0.5F, 1e-4F);
  EXPECT_NE(result.limits & core::limit_bit(core::Limit::kAxis), 0U);
}

TEST(SafetyGate, RefusesInvalidLimitsWithoutEffect) {
  const auto refused = [](auto&& change) {
    SafetyGate gate;
    core::GateLimits limits = short_ramp();
    EXPECT_TRUE(gate.configure(limits));
    change(limits);
    const bool result = !gate.configure(limits);
    return result && gate.limits().force_max_N == 7.3F && gate.limits().ramp_ticks == 5U;
  };
  for (const float bad :
       {0.0F, -1.0F, 1e6F, kInfinity, -kInfinity, std::numeric_limits<float>::quiet_NaN()}) {
    EXPECT_TRUE(refused([bad](core::GateLimits& l) { l.force_max_N = bad; })) << bad;
    EXPECT_TRUE(refused([bad](core::GateLimits& l) { l.slew_N_per_tick = bad; })) << bad;
    for (std::uint32_t axis = 0; axis < core::kAxes; ++axis) {
      EXPECT_TRUE(refused([=](core::GateLimits& l) { l.effort_max[axis] = bad; })) << bad;
      EXPECT_TRUE(refused([=](core::GateLimits& l) { l.effort_slew_per_tick[axis] = bad; })) << bad;
    }
  }
  EXPECT_TRUE(refused([](core::GateLimits& l) { l.ramp_ticks = 1; }));
  EXPECT_TRUE(refused([](core::GateLimits& l) { l.ramp_ticks = 1000001; }));
}

// A limit on one axis reduces the force and keeps its direction.
TEST(SafetyGate, KeepsDirectionUnderGravitySaturation) {
  core::GateLimits limits;
  limits.ramp_ticks = 2;
  limits.force_max_N = 100.0F;
  limits.slew_N_per_tick = 200.0F;
  for (std::uint32_t i = 0; i < core::kAxes; ++i) {
    limits.effort_max[i] = 1.0F;
    limits.effort_slew_per_tick[i] = 2.0F;
  }
  constexpr Mat3 kMap{{{0.2F, 0.1F, 0.0F}, {0.0F, 0.15F, -0.1F}, {0.05F, 0.0F, 0.2F}}};
  std::mt19937 random(7);
  std::uniform_real_distribution<float> unit(-1.0F, 1.0F);
  SafetyGate gate;
  ASSERT_TRUE(gate.configure(limits));
  gate.command({}, kMap);
  gate.command({}, kMap);
  int saturated = 0;
  for (int i = 0; i < 10000; ++i) {
    const Vec3 force = 20.0F * Vec3{unit(random), unit(random), unit(random)};
    const Vec3 own = 0.5F * Vec3{unit(random), unit(random), unit(random)};
    const SafetyGate::Result result = gate.command(force, kMap, own);
    const Vec3 wanted = kMap * result.force;
    const Vec3 shown =
        Vec3{result.command.effort(0), result.command.effort(1), result.command.effort(2)} - own;
    const Vec3 turn = core::cross(wanted, shown);
    ASSERT_LE(core::length(turn), 2e-5F * core::length(wanted));
    ASSERT_GE(core::dot(wanted, shown), 0.0F);
    saturated += core::length(shown) < 0.99F * core::length(wanted) ? 1 : 0;
    const bool told = (result.limits & core::limit_bit(core::Limit::kAxis)) != 0U;
    ASSERT_TRUE(told || core::length(shown) > 0.9999F * core::length(wanted));
  }
  EXPECT_GT(saturated, 3000);
  EXPECT_LT(saturated, 9900);
}

TEST(SafetyGate, SlewsAllAxesTogether) {
  core::GateLimits limits = roomy();
  for (float& slew : limits.effort_slew_per_tick) {
    slew = 0.5F;
  }
  SafetyGate gate = ramped(limits);
  const SafetyGate::Result result = gate.command({4.0F, -2.0F, 1.0F}, kIdentity);
  EXPECT_NEAR(result.command.effort(0), 0.5F, 1e-4F);
  EXPECT_NEAR(result.command.effort(1), -0.25F, 1e-4F);
  EXPECT_NEAR(result.command.effort(2), 0.125F, 1e-4F);
}

TEST(SafetyGate, ClipsGravityAboveAxisLimit) {
  core::GateLimits limits;
  limits.ramp_ticks = 2;
  limits.slew_N_per_tick = 16.0F;
  for (float& slew : limits.effort_slew_per_tick) {
    slew = 16.0F;
  }
  SafetyGate gate;
  ASSERT_TRUE(gate.configure(limits));
  for (int i = 0; i < 4; ++i) {
    const SafetyGate::Result result =
        gate.command({5.0F, 0.0F, 0.0F}, kIdentity, {99.0F, 0.0F, 0.0F});
    ASSERT_LE(result.command.effort(0), 8.5F);
    ASSERT_EQ((result.limits & core::limit_bit(core::Limit::kAxis)) != 0U, i > 0);
  }
  EXPECT_TRUE(gate.command({}, kIdentity, {kInfinity, 0.0F, 0.0F}).not_finite);
}

}  // namespace
}  // namespace tactree::test
