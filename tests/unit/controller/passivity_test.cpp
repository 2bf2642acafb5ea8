// Energy is counted exactly, and taken back only where it was given.

#include "tactree/core/passivity.hpp"

#include <gtest/gtest.h>

namespace tactree::test {
namespace {

using core::PassivityController;
using core::Vec3;

PassivityController controller(float delay_s = 0.0F) {
  PassivityController p;
  p.configure(1e-3F, 2.0F, delay_s);
  return p;
}

Vec3 at(float z) { return {0.0F, 0.0F, z}; }

TEST(Passivity, AWallThatTakesEnergyIsLeftAlone) {
  PassivityController p = controller();
  EXPECT_EQ(p.update({}, {at(0.0F), at(-0.1F), {}}, 0.0F), Vec3{});
  for (int i = 1; i < 100; ++i) {  // pushes with 1 N against the motion, stores nothing
    ASSERT_EQ(p.update(at(1.0F), {at(-1e-4F * static_cast<float>(i)), at(-0.1F), {}}, 0.0F),
              Vec3{});
  }
  EXPECT_EQ(p.balance(), 0.0F);  // what was taken is no credit
}

TEST(Passivity, WhatIsGivenIsTakenBackByDampingAndNoMoreThanAllowed) {
  PassivityController p = controller();
  (void)p.update({}, {at(0.0F), at(0.1F), {}}, 0.0F);
  // 1 mN along 0.1 mm: 1e-7 J, in a period at 0.1 m/s: 1e-7 / (1e-3 * 0.01) = 0.01 Ns/m.
  const Vec3 a_little = p.update(at(1e-3F), {at(1e-4F), at(0.1F), {}}, 0.0F);
  EXPECT_NEAR(p.balance(), -1e-7F, 1e-12F);
  EXPECT_NEAR(a_little.z, -0.01F * 0.1F, 1e-6F);
  const Vec3 most = p.update(at(1.0F), {at(2e-4F), at(0.1F), {}}, 0.0F);
  EXPECT_NEAR(most.z, -2.0F * 0.1F, 1e-6F);
  EXPECT_EQ(p.update({}, {at(2e-4F), {}, {}}, 0.0F), Vec3{});  // nothing to damp
}

TEST(Passivity, TheSpringsEnergyIsItsOwn) {
  PassivityController p = controller();
  (void)p.update({}, {at(0.0F), {}, {}}, 1e-3F);
  (void)p.update(at(1.0F), {at(1e-3F), at(1.0F), {}}, 0.0F);
  EXPECT_NEAR(p.balance(), 0.0F, 1e-9F);
}

TEST(Passivity, ADelayedForceWorksLater) {
  PassivityController p = controller(1.5e-3F);
  (void)p.update({}, {at(0.0F), {}, {}}, 0.0F);
  (void)p.update(at(1.0F), {at(1e-3F), {}, {}}, 0.0F);
  EXPECT_EQ(p.balance(), 0.0F);  // not there yet
  (void)p.update({}, {at(2e-3F), {}, {}}, 0.0F);
  EXPECT_NEAR(p.balance(), -0.5e-3F, 1e-8F);  // half a tick of it
  (void)p.update({}, {at(3e-3F), {}, {}}, 0.0F);
  EXPECT_NEAR(p.balance(), -1e-3F, 1e-8F);
}

TEST(Passivity, ResetForgets) {
  PassivityController p = controller();
  (void)p.update({}, {at(0.0F), {}, {}}, 0.0F);
  (void)p.update(at(1.0F), {at(1e-3F), {}, {}}, 0.0F);
  p.reset();
  EXPECT_EQ(p.balance(), 0.0F);
  EXPECT_EQ(p.update(at(1.0F), {at(1.0F), at(1.0F), {}}, 0.0F), Vec3{});  // no way from before
}

}  // namespace
// A wall that pushes the hand away gives energy, but of the motor that moves it.
TEST(Passivity, DoesNotDampWhatAMovingWallGives) {
  PassivityController p = controller();
  (void)p.update({}, {at(0.0F), {}, {}}, 0.0F);
  EXPECT_EQ(p.update(at(1.0F), {at(1e-3F), at(1.0F), at(1.0F)}, 0.0F), Vec3{});
  EXPECT_LT(p.update(at(1.0F), {at(3e-3F), at(2.0F), at(1.0F)}, 0.0F).z, 0.0F);
}

}  // namespace tactree::test
