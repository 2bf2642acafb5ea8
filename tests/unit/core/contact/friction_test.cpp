// Dry friction at the proxy, on a plane, where the ratio of the forces is the coefficient.

#include <gtest/gtest.h>

#include <algorithm>

#include "analytic_shapes.hpp"
#include "tactree/core/contact/proxy.hpp"

namespace tactree::test {
namespace {

constexpr core::Friction kRough{0.4F, 0.3F};
constexpr double kDepth = 1e-3;

class FrictionOnAPlane : public ::testing::Test {
 protected:
  void SetUp() override {
    proxy_.reset({0.0F, 0.0F, 0.003F});
    for (double z = 0.003; z > -kDepth; z -= 5e-5) {
      move(0.0, z);
    }
    move(0.0, -kDepth);
  }

  /// Tangential over normal force.
  double move(double x, double z = -kDepth) {
    proxy_.update(shape_.view(), narrow({x, 0.0, z}), kRough, core::work_per_tick(1000.0F));
    const Eigen::Vector3d displacement = widen(proxy_.position()) - Eigen::Vector3d(x, 0.0, z);
    return std::abs(displacement.x() / displacement.z());
  }

  Shape shape_ = plane();
  core::Proxy proxy_;
};

TEST_F(FrictionOnAPlane, SlidesWithDynamicCoefficient) {
  double low = 1.0;
  double high = 0.0;
  for (int tick = 0; tick < 200; ++tick) {
    const double ratio = move(tick * 1e-4);
    if (tick > 20) {
      low = std::min(low, ratio);
      high = std::max(high, ratio);
    }
  }
  EXPECT_GE(low, 0.295);
  EXPECT_LE(high, 0.305);
}

TEST_F(FrictionOnAPlane, BreaksAwayAtStaticCone) {
  const core::Vec3 before = proxy_.position();
  double x = 0.0;
  for (; x < 0.395 * kDepth; x += 5e-6) {
    move(x);
    ASSERT_EQ(proxy_.position(), before) << x;
    ASSERT_FALSE(proxy_.slipping());
  }
  for (; x < 0.415 * kDepth; x += 5e-6) {
    move(x);
  }
  EXPECT_TRUE(proxy_.slipping());
  EXPECT_NE(proxy_.position(), before);
}

// Slower than one encoder count a tick the probe rests now and then; the hand has not stopped.
TEST_F(FrictionOnAPlane, SlidesSteadilyAtLowSpeed) {
  double low = 1.0;
  double high = 0.0;
  for (int tick = 0; tick < 2000; ++tick) {
    const double ratio = move((tick / 5) * 30e-6);
    if (tick > 200) {
      low = std::min(low, ratio);
      high = std::max(high, ratio);
    }
  }
  EXPECT_GE(low, 0.295);
  EXPECT_LE(high, 0.305);
}

TEST_F(FrictionOnAPlane, SticksAfterReversal) {
  const double end = 5e-3;
  for (double to = 0.0; to < end; to += 1e-4) {
    move(to);
  }
  move(end);
  const core::Vec3 turn = proxy_.position();
  double x = end;
  for (; x > end - 0.6 * kDepth; x -= 1e-5) {
    move(x);
    ASSERT_EQ(proxy_.position(), turn) << x;
  }
  for (; x > end - 0.9 * kDepth; x -= 1e-5) {
    move(x);
  }
  EXPECT_LT(proxy_.position().x, turn.x);
}

}  // namespace
}  // namespace tactree::test
