// Energy is measured exactly, and absorbed only after its release.

#include "tactree/core/control/passivity.hpp"

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

TEST(Passivity, LeavesAbsorbingWallUndamped) {
  PassivityController p = controller();
  EXPECT_EQ(p.update({}, {at(0.0F), at(-0.1F), {}}, 0.0F), Vec3{});
  for (int i = 1; i < 100; ++i) {  // pushes with 1 N against the motion, stores nothing
    ASSERT_EQ(p.update(at(1.0F), {at(-1e-4F * static_cast<float>(i)), at(-0.1F), {}}, 0.0F),
              Vec3{});
  }
  EXPECT_EQ(p.observed_energy(), 0.0F);  // what was taken is no credit
}

TEST(Passivity, DampsReleasedEnergyWithinLimit) {
  PassivityController p = controller();
  (void)p.update({}, {at(0.0F), at(0.1F), {}}, 0.0F);
  // 1 mN along 0.1 mm: 1e-7 J, in a period at 0.1 m/s: 1e-7 / (1e-3 * 0.01) = 0.01 Ns/m.
  const Vec3 a_little = p.update(at(1e-3F), {at(1e-4F), at(0.1F), {}}, 0.0F);
  EXPECT_NEAR(p.observed_energy(), -1e-7F, 1e-12F);
  EXPECT_NEAR(a_little.z, -0.01F * 0.1F, 1e-6F);
  const Vec3 most = p.update(at(1.0F), {at(2e-4F), at(0.1F), {}}, 0.0F);
  EXPECT_NEAR(most.z, -2.0F * 0.1F, 1e-6F);
  EXPECT_EQ(p.update({}, {at(2e-4F), {}, {}}, 0.0F), Vec3{});  // nothing to damp
}

TEST(Passivity, AllowsReleaseOfStoredEnergy) {
  PassivityController p = controller();
  (void)p.update({}, {at(0.0F), {}, {}}, 1e-3F);
  (void)p.update(at(1.0F), {at(1e-3F), at(1.0F), {}}, 0.0F);
  EXPECT_NEAR(p.observed_energy(), 0.0F, 1e-9F);
}

TEST(Passivity, AccountsForForceDelay) {
  PassivityController p = controller(1.5e-3F);
  (void)p.update({}, {at(0.0F), {}, {}}, 0.0F);
  (void)p.update(at(1.0F), {at(1e-3F), {}, {}}, 0.0F);
  EXPECT_EQ(p.observed_energy(), 0.0F);  // not there yet
  (void)p.update({}, {at(2e-3F), {}, {}}, 0.0F);
  EXPECT_NEAR(p.observed_energy(), -0.5e-3F, 1e-8F);  // half a tick of it
  (void)p.update({}, {at(3e-3F), {}, {}}, 0.0F);
  EXPECT_NEAR(p.observed_energy(), -1e-3F, 1e-8F);
}

TEST(Passivity, ClearsEnergyOnReset) {
  PassivityController p = controller();
  (void)p.update({}, {at(0.0F), {}, {}}, 0.0F);
  (void)p.update(at(1.0F), {at(1e-3F), {}, {}}, 0.0F);
  p.reset();
  EXPECT_EQ(p.observed_energy(), 0.0F);
  EXPECT_EQ(p.update(at(1.0F), {at(1.0F), at(1.0F), {}}, 0.0F), Vec3{});  // no way from before
}

// A hand that leaves at 0.5 m/s: at 2000 N/s the push ends in 0.5 ms per newton, delayed by 1 ms,
// and releases energy until then.
TEST(Passivity, LimitsWallPushWhenLeaving) {
  for (const float delay_s : {0.0F, 1.5e-3F}) {
    PassivityController p = controller(delay_s);
    (void)p.update({}, {at(0.0F), {}, {}}, 0.0F);
    EXPECT_EQ(p.most_push(0.5F, 2000.0F), 0.0F);  // it got nothing yet
    for (int i = 1; i <= 10; ++i) {               // 2 N against 1 mm
      (void)p.update(at(2.0F), {at(-1e-4F * static_cast<float>(i)), {}, {}}, 0.0F);
    }
    const float push = p.most_push(0.5F, 2000.0F);
    const float taken = delay_s > 0.0F ? 2.0F * 0.85e-3F : 2.0F * 1e-3F;  // it came later
    EXPECT_NEAR(push * (push / (2.0F * 2000.0F) + delay_s + 1e-3F) * 0.5F, taken, 1e-5F);
    EXPECT_GT(p.most_push(0.01F, 2000.0F), 10.0F);  // a slow hand is not kept from anything
    (void)p.update(at(2.0F), {at(1.0F), {}, {}}, 0.0F);
    (void)p.update(at(2.0F), {at(2.0F), {}, {}}, 0.0F);
    (void)p.update(at(2.0F), {at(3.0F), {}, {}}, 0.0F);
    EXPECT_EQ(p.most_push(0.5F, 2000.0F), 0.0F);  // more was given than taken
    p.reset();
    EXPECT_EQ(p.most_push(0.5F, 2000.0F), 0.0F);
  }
}

// After pressing during the ramp, or a move of the wall: the spring may release its energy, also to
// a trembling hand.
TEST(Passivity, LetsWallReleaseApplicationEnergy) {
  constexpr float kStored = 0.6F * 0.6F / (2.0F * 300.0F);  // J: 0.6 N of 300 N/m
  PassivityController p = controller();
  p.allow(kStored);
  (void)p.update({}, {at(-2e-3F), {}, {}}, kStored);
  const float push = p.most_push(0.05F, 2000.0F);
  EXPECT_NEAR(push * (push / (2.0F * 2000.0F) + 1e-3F) * 0.05F, kStored, 1e-6F);
  p.allow(0.5F * kStored);  // it may give more already
  EXPECT_EQ(p.most_push(0.05F, 2000.0F), push);
  p.reset();
  EXPECT_EQ(p.most_push(0.05F, 2000.0F), 0.0F);
}

// A contact that starts deep inside has absorbed no energy.
TEST(Passivity, CreditsDeepContactNoEnergy) {
  PassivityController p = controller();
  (void)p.update({}, {at(-5e-3F), {}, {}}, 0.02F);
  EXPECT_EQ(p.most_push(0.5F, 2000.0F), 0.0F);
}

// A moving wall that pushes the hand supplies energy of the motion, not of a leak.
TEST(Passivity, LeavesMovingWallWorkUndamped) {
  PassivityController p = controller();
  (void)p.update({}, {at(0.0F), {}, {}}, 0.0F);
  EXPECT_EQ(p.update(at(1.0F), {at(1e-3F), at(1.0F), at(1.0F)}, 0.0F), Vec3{});
  EXPECT_LT(p.update(at(1.0F), {at(3e-3F), at(2.0F), at(1.0F)}, 0.0F).z, 0.0F);
}

}  // namespace
}  // namespace tactree::test
