// Detection of a constant count under a changing effort.

#include "tactree/core/safety/encoder_watch.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace tactree::test {
namespace {

using core::EncoderWatch;
using core::kAxes;

constexpr std::uint32_t kTicks = 100;

/// First tick reported as stuck within `ticks` ticks, for a count and an effort of axis 1 by tick.
template <class Count, class Effort>
int first_complaint(int ticks, Count count, Effort effort) {
  EncoderWatch watch;
  watch.configure(kTicks);
  for (int i = 0; i < ticks; ++i) {
    const std::int32_t counts[kAxes] = {i, count(i), -i};
    const float share[kAxes] = {0.0F, effort(i), 0.0F};
    if (!watch.update(counts, share, kAxes)) {
      return i;
    }
  }
  return -1;
}

int still(int) { return 7; }

TEST(EncoderWatch, DetectsStandstillUnderRisingEffort) {
  const auto rising = [](int i) { return static_cast<float>(i) / 300.0F; };
  const int tick = first_complaint(1000, still, rising);
  EXPECT_GE(tick, static_cast<int>(kTicks));
  EXPECT_LE(tick, 101 + static_cast<int>(kTicks / EncoderWatch::kSettling));
}

TEST(EncoderWatch, DetectsStandstillUnderAlternatingEffort) {
  const auto shaking = [](int i) { return i % 20 < 10 ? 0.15F : -0.15F; };
  EXPECT_GE(first_complaint(1000, still, shaking), static_cast<int>(kTicks));
}

TEST(EncoderWatch, AcceptsHandHoldingStill) {
  EXPECT_EQ(first_complaint(10000, still, [](int) { return 0.9F; }), -1);
}

TEST(EncoderWatch, AcceptsOccasionalCounts) {
  const auto slow = [](int i) { return i / 90; };
  const auto rising = [](int i) { return static_cast<float>(i % 1000) / 1000.0F; };
  EXPECT_EQ(first_complaint(10000, slow, rising), -1);
}

TEST(EncoderWatch, AcceptsEffortLaggingMotion) {
  const auto stops = [](int i) { return i < 50 ? i : 50; };
  const auto settles = [](int i) { return i < 60 ? 0.0F : 0.8F; };
  EXPECT_EQ(first_complaint(5000, stops, settles), -1);
}

TEST(EncoderWatch, IgnoresUnusedAxes) {
  EncoderWatch watch;
  watch.configure(10);
  for (int i = 0; i < 100; ++i) {
    const std::int32_t counts[kAxes] = {i, 0, 0};
    const float share[kAxes] = {0.0F, 0.01F * static_cast<float>(i), 0.0F};
    ASSERT_TRUE(watch.update(counts, share, 1));
  }
}

TEST(EncoderWatch, ClearsHistoryOnReset) {
  EncoderWatch watch;
  watch.configure(kTicks);
  const std::int32_t counts[kAxes] = {0, 0, 0};
  for (int i = 0; i < 5000; ++i) {
    const float share[kAxes] = {i % 50 == 0 ? 1.0F : 0.0F, 0.0F, 0.0F};
    ASSERT_TRUE(watch.update(counts, share, kAxes));
    if (i % 90 == 0) {
      watch.reset();
    }
  }
}

TEST(EncoderWatch, WatchesEveryAxis) {
  for (std::uint32_t axis = 0; axis < kAxes; ++axis) {
    EncoderWatch watch;
    watch.configure(kTicks);
    bool fine = true;
    for (int i = 0; i < 200; ++i) {
      std::int32_t counts[kAxes] = {i, -i, 3 * i};
      float share[kAxes] = {0.0F, 0.0F, 0.0F};
      counts[axis] = 7;
      share[axis] = static_cast<float>(i) / 150.0F;
      fine = watch.update(counts, share, kAxes) && fine;
    }
    EXPECT_FALSE(fine) << axis;
  }
}

// One step of the effort, at the end of the settling time or one tick before.
TEST(EncoderWatch, IgnoresEffortChangesDuringSettling) {
  const int settled = static_cast<int>(kTicks / EncoderWatch::kSettling);
  for (const float sign : {1.0F, -1.0F}) {
    const auto step_at = [&](int when) {
      return first_complaint(500, still, [=](int i) { return i < when ? 0.0F : sign * 0.5F; });
    };
    EXPECT_EQ(step_at(settled), -1);
    EXPECT_EQ(step_at(settled + 1), static_cast<int>(kTicks));
  }
}

// An axis that rests without a force needs time to follow a force that begins.
TEST(EncoderWatch, AxisHasTimeToFollowForce) {
  const int settling = static_cast<int>(kTicks / EncoderWatch::kSettling);
  const int begin = 5 * static_cast<int>(kTicks);
  const auto step = [=](int i) { return i < begin ? 0.0F : 0.5F; };
  const auto follows_after = [=](int delay) {
    return first_complaint(
        1000, [=](int i) { return i < begin + delay ? 7 : 7 + i; }, step);
  };
  EXPECT_EQ(follows_after(settling), -1);
  EXPECT_EQ(follows_after(settling + 1), begin + settling);
  EXPECT_EQ(first_complaint(1000, still, step), begin + settling);
}

TEST(EncoderWatch, RequiresMotionAboveEffortThreshold) {
  const auto steps_by = [](float change) {
    return first_complaint(500, still, [=](int i) { return i < 50 ? 0.0F : change; });
  };
  EXPECT_EQ(steps_by(EncoderWatch::kChange), -1);
  EXPECT_EQ(steps_by(std::nextafter(EncoderWatch::kChange, 1.0F)), static_cast<int>(kTicks));
}

}  // namespace
}  // namespace tactree::test
