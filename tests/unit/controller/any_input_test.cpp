// Whatever comes in tick after tick: the force is finite, within its limit and its slew, and zero
// outside the active state.

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <random>
#include <span>
#include <vector>

#include "session.hpp"

namespace tactree::test {
namespace {

using core::Command;
using core::State;

struct Counts {
  std::uint64_t broken = 0;
  std::uint64_t active = 0;
  std::uint64_t with_force = 0;
};

void inspect(const core::Output& output, const core::Output& last, const core::Configuration& c,
             Counts& counts) {
  double now = 0.0;
  double step = 0.0;
  for (std::uint32_t axis = 0; axis < core::kAxes; ++axis) {
    const double effort = static_cast<double>(output.motors.effort(axis));
    const double before = static_cast<double>(last.motors.effort(axis));
    counts.broken += std::isfinite(effort) ? 0U : 1U;
    now += effort * effort;
    step += (effort - before) * (effort - before);
  }
  const bool active = output.status.state == State::kActive;
  const double slew = static_cast<double>(c.slew_N_s) / static_cast<double>(c.rate_hz);
  counts.broken += std::sqrt(now) <= static_cast<double>(c.force_max_N) ? 0U : 1U;
  counts.broken += !active || std::sqrt(step) <= slew ? 0U : 1U;
  counts.broken += active || output.motors.is_zero() ? 0U : 1U;
  counts.broken += output.enable || output.motors.is_zero() ? 0U : 1U;
  counts.broken += output.status.state != State::kFault || !output.enable ? 0U : 1U;
  counts.active += active ? 1U : 0U;
  counts.with_force += output.motors.is_zero() ? 0U : 1U;
}

/// Walks at random in and about the plane.
class WildHand {
 public:
  WildHand(double step_m, double height_m, double width_m)
      : step_m_(step_m), height_m_(height_m), width_m_(width_m) {}
  void move(Session& session, std::mt19937& random) {
    z_ = std::clamp(z_ + step_m_ * unit_(random), -height_m_, height_m_);
    x_ = std::clamp(x_ + step_m_ * unit_(random), -width_m_, width_m_);
    session.move(x_, 1e-3, z_);
  }

 private:
  double step_m_, height_m_, width_m_;
  std::uniform_real_distribution<double> unit_{-1.0, 1.0};
  double z_ = 0.01;
  double x_ = 0.0;
};

constexpr std::uint32_t kPhases = 1000U;
/// Whatever happened, every kPhases ticks it begins anew; the hand comes to the dead-man control
/// after 20 of them.
Command command_of(std::uint32_t tick) {
  constexpr Command kBeginAnew[] = {Command::kClearFault, Command::kStop, Command::kArm};
  const std::uint32_t phase = tick % kPhases;
  return phase < 3U ? kBeginAnew[phase] : Command::kNone;
}
bool has_hand(std::uint32_t tick) { return tick % kPhases > 20U; }

TEST(AnyInput, RandomEncodersAndSwitchesKeepThePromises) {
  core::Configuration configuration;
  configuration.ramp_s = 0.01F;
  Session session(configuration);
  core::Output last = session.step();
  Counts counts;
  std::mt19937 random(11);
  for (std::uint32_t i = 0; i < 1'000'000U; ++i) {
    for (std::uint32_t axis = 0; axis < core::kAxes; ++axis) {
      session.input.encoders.counts[axis] = static_cast<std::int32_t>(random());
      session.input.encoders.valid[axis] = random() % 16U != 0U;
    }
    session.input.emergency_stop = random() % 8U == 0U;
    session.input.dead_man = random() % 2U == 0U;
    session.input.motors_ok = random() % 8U != 0U;
    session.input.link_alive = random() % 2U == 0U;
    session.input.enable_read_back = random() % 2U == 0U;
    session.enable_follows = random() % 2U == 0U;
    session.input.overruns = random() % 64U == 0U ? static_cast<std::uint32_t>(random()) : 0U;
    const core::Output output = session.step(static_cast<Command>(random() % 6U));
    inspect(output, last, configuration, counts);
    last = output;
  }
  EXPECT_EQ(counts.broken, 0U);
}

// Mostly plausible, so that there is force to watch: a wild hand in and about the object.
TEST(AnyInput, AWildHandKeepsThePromises) {
  core::Configuration configuration;
  configuration.ramp_s = 0.01F;
  configuration.stiffness_N_m = 3000.0F;
  configuration.force_max_N = 3.0F;
  configuration.slew_N_s = 500.0F;
  configuration.speed_max_m_s = 20.0F;
  Session session(configuration);
  ASSERT_EQ(session.status, core::ConfigurationStatus::kOk);
  core::Output last = session.step();
  Counts counts;
  std::mt19937 random(12);
  WildHand hand(2e-3, 8e-3, 0.025);
  for (std::uint32_t i = 0; i < 300'000U; ++i) {
    hand.move(session, random);
    session.input.dead_man = has_hand(i) && random() % 4096U != 0U;
    session.input.emergency_stop = random() % 4096U == 0U;
    const core::Output output = session.step(command_of(i));
    inspect(output, last, configuration, counts);
    last = output;
  }
  EXPECT_EQ(counts.broken, 0U);
  EXPECT_GT(counts.active, 100'000U);
  EXPECT_GT(counts.with_force, 50'000U);
}

// Bits of the points flip while the object is touched: whatever surface that makes, the gate knows
// nothing of it.
TEST(AnyInput, PointsThatChangeMeanwhileKeepThePromises) {
  core::Configuration configuration;
  configuration.ramp_s = 0.01F;
  configuration.force_max_N = 3.0F;
  configuration.slew_N_s = 500.0F;
  configuration.speed_max_m_s = 20.0F;
  const std::span<const std::byte> sound = shared_plane().bytes();
  std::vector<std::uint32_t> words(sound.size() / 4U);
  std::memcpy(words.data(), sound.data(), sound.size());
  core::BlobView view;
  ASSERT_EQ(core::open_blob(std::as_bytes(std::span(words)), view), core::BlobStatus::kOk);
  const std::size_t first = static_cast<std::size_t>(view.point_words() - words.data());
  Session session(configuration);
  ASSERT_EQ(session.controller.load_model(view), core::ModelStatus::kOk);
  session.activate();
  core::Output last = session.step();
  Counts counts;
  std::mt19937 random(13);
  WildHand hand(5e-4, 6e-3, 0.015);
  for (std::uint32_t i = 0; i < 100'000U; ++i) {
    hand.move(session, random);
    words[first + random() % view.point_count()] ^= 1U << (random() % 32U);
    session.input.dead_man = has_hand(i);
    const core::Output output = session.step(command_of(i));
    inspect(output, last, configuration, counts);
    last = output;
  }
  EXPECT_EQ(counts.broken, 0U);
  EXPECT_GT(counts.with_force, 10'000U);
}

}  // namespace
}  // namespace tactree::test
