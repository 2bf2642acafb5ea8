// What is left of a contact goes to zero in a straight line.

#include "tactree/core/contact/force_fade.hpp"

#include <gtest/gtest.h>

namespace tactree::test {
namespace {

using core::ForceFade;
using core::Vec3;

TEST(ForceFade, FallsLinearlyToZero) {
  ForceFade fade;
  EXPECT_FALSE(fade.active());
  EXPECT_EQ(fade.next(), Vec3{});
  fade.begin({8.0F, -4.0F, 0.0F}, 8);
  for (int left = 7; left >= 0; --left) {
    EXPECT_TRUE(fade.active());
    const auto share = static_cast<float>(left);
    EXPECT_EQ(fade.next(), (Vec3{share, -0.5F * share, 0.0F}));
  }
  EXPECT_FALSE(fade.active());
  EXPECT_EQ(fade.next(), Vec3{});
}

TEST(ForceFade, AddsRestOfEarlierForce) {
  ForceFade fade;
  fade.begin({8.0F, 0.0F, 0.0F}, 8);
  (void)fade.next();
  EXPECT_EQ(fade.next().x, 6.0F);
  fade.begin({0.0F, 2.0F, 0.0F}, 4);
  EXPECT_EQ(fade.next(), (Vec3{4.5F, 1.5F, 0.0F}));
}

TEST(ForceFade, ForgetsFinishedFade) {
  ForceFade fade;
  fade.begin({8.0F, 0.0F, 0.0F}, 1);
  EXPECT_EQ(fade.next(), Vec3{});
  fade.begin({0.0F, 2.0F, 0.0F}, 2);
  EXPECT_EQ(fade.next(), (Vec3{0.0F, 1.0F, 0.0F}));
  fade.stop();
  EXPECT_FALSE(fade.active());
  EXPECT_EQ(fade.next(), Vec3{});
}

}  // namespace
}  // namespace tactree::test
