// A contact that disappears under the hand leaves no step: whatever took the body away, the force
// goes down within kFadeSeconds.

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "scene_rig.hpp"

namespace tactree::test {
namespace {

using core::ModelStatus;

constexpr int kFadeTicks = 50;  // kFadeSeconds at 1 kHz
static_assert(core::kFadeSeconds == 0.05F);

/// Pressed 2 mm into body 0; nobody else is near.
SceneRig pressed() {
  SceneRig rig;
  rig.add(sheet());
  rig.add(sheet(), isometry({0.0, 0.0, -1.0}));
  rig.tick({0.0, 0.0, 0.005});
  rig.go({0.0, 0.0, -0.002});
  EXPECT_NEAR(rig.force().z(), 1.0, 0.01);
  return rig;
}

/// From the force of the last tick to zero in a straight line, while the probe rests.
void expect_fade(SceneRig& rig) {
  const Eigen::Vector3d whole = rig.force();
  for (int left = kFadeTicks - 1; left >= 0; --left) {
    rig.rest(1);
    ASSERT_LT((rig.force() - (static_cast<double>(left) / kFadeTicks) * whole).norm(), 1e-5);
    ASSERT_TRUE(rig.last.fading);
    ASSERT_FALSE(rig.last.contact.in_contact);
    ASSERT_EQ(rig.last.reactions[0].body, core::kNoBody);
  }
  rig.rest(1);
  EXPECT_EQ(rig.force().norm(), 0.0);
  EXPECT_FALSE(rig.last.fading);
}

TEST(SceneFade, FadesForceOfRemovedBody) {
  SceneRig rig = pressed();
  ASSERT_EQ(rig.scene.remove(0), ModelStatus::kOk);
  expect_fade(rig);
}

TEST(SceneFade, FadesForceOfDisabledBody) {
  SceneRig rig = pressed();
  ASSERT_EQ(rig.scene.enable(0, false), ModelStatus::kOk);
  expect_fade(rig);
}

TEST(SceneFade, FadesForceOfJumpingBody) {
  SceneRig rig = pressed();
  ASSERT_EQ(rig.scene.move(0, to_core(isometry({0.1, 0.0, 0.0})), {}), ModelStatus::kOk);
  expect_fade(rig);
}

// It does not snatch the hand to where the proxy went.
TEST(SceneFade, FadesJumpWithinContact) {
  SceneRig rig = pressed();
  ASSERT_EQ(rig.scene.move(0, to_core(isometry({0.0, 0.0, 0.03})), {}), ModelStatus::kOk);
  expect_fade(rig);
}

TEST(SceneFade, FadesForceAtSurfaceEnd) {
  SceneRig rig = pressed();
  Eigen::Vector3d before = rig.force();
  double furthest_step = 0.0;
  for (double x = 0.0; x < 0.03; x += 2e-5) {
    rig.tick({x, 0.0, -0.002});
    furthest_step = std::max(furthest_step, (rig.force() - before).norm());
    before = rig.force();
  }
  rig.rest(kFadeTicks);
  EXPECT_EQ(rig.force().norm(), 0.0);
  EXPECT_LT(furthest_step, 0.05);
}

// Too short a move for a jump, and yet there is nothing any more where the contact was.
TEST(SceneFade, FadesForceOfDepartingBody) {
  SceneRig rig = pressed();
  rig.go({0.015, 0.0, -0.002});
  ASSERT_EQ(rig.scene.move(0, to_core(isometry({-0.015, 0.0, 0.0})), {}), ModelStatus::kOk);
  Eigen::Vector3d whole = rig.force();
  for (int i = 0; i < 10 && rig.rest(1).contact.in_contact; ++i) {
    whole = rig.force();
  }
  ASSERT_GT(whole.norm(), 1.0);
  for (int left = kFadeTicks - 1; left >= 0; --left) {
    ASSERT_LT((rig.force() - (static_cast<double>(left) / kFadeTicks) * whole).norm(), 1e-4);
    rig.rest(1);
  }
}

TEST(SceneFade, ContinuesAfterSlotReuse) {
  SceneRig rig = pressed();
  ASSERT_EQ(rig.scene.remove(0), ModelStatus::kOk);
  rig.rest(10);
  EXPECT_EQ(rig.add(sheet()), 0U);  // the same number, around the probe
  const double left = rig.force().z();
  EXPECT_NEAR(left, 0.8, 0.01);
  rig.rest(20);
  EXPECT_NEAR(rig.force().z(), 0.4, 0.01);
  rig.rest(kFadeTicks);
  EXPECT_EQ(rig.force().norm(), 0.0);
}

// The side on which the probe finds itself is the free one: the surface holds it from there.
TEST(SceneFade, AvoidsExpulsionFromNewBody) {
  const std::function<void(SceneRig&)> appear[] = {
      [](SceneRig& rig) { rig.add(sheet()); },
      [](SceneRig& rig) { EXPECT_EQ(rig.scene.enable(0, true), ModelStatus::kOk); },
      [](SceneRig& rig) {
        EXPECT_EQ(rig.scene.enable(0, true), ModelStatus::kOk);
        EXPECT_EQ(rig.scene.move(0, to_core(isometry({0.0, 0.0, 0.0005})), {}), ModelStatus::kOk);
      },
      [](SceneRig& rig) {  // from below the probe to above it while it is not there
        EXPECT_EQ(rig.scene.move(0, to_core(isometry({0.0, 0.0, -0.004})), {}), ModelStatus::kOk);
        rig.rest(1);
        EXPECT_EQ(rig.scene.enable(0, true), ModelStatus::kOk);
        EXPECT_EQ(rig.scene.move(0, {}, {}), ModelStatus::kOk);
      },
      [](SceneRig& rig) {  // the same within one tick
        EXPECT_EQ(rig.scene.move(0, to_core(isometry({0.0, 0.0, -0.004})), {}), ModelStatus::kOk);
        EXPECT_EQ(rig.scene.enable(0, true), ModelStatus::kOk);
        rig.rest(1);
        EXPECT_EQ(rig.scene.enable(0, false), ModelStatus::kOk);
        EXPECT_EQ(rig.scene.move(0, {}, {}), ModelStatus::kOk);
        EXPECT_EQ(rig.scene.enable(0, true), ModelStatus::kOk);
      }};
  for (const auto& how : appear) {
    SceneRig rig;
    rig.add(sheet());
    ASSERT_EQ(rig.scene.enable(0, false), ModelStatus::kOk);
    rig.tick({0.0, 0.0, 0.01});
    rig.go({0.0, 0.0, -0.002});
    EXPECT_EQ(rig.force().norm(), 0.0);
    how(rig);
    EXPECT_LT(rig.rest(1).contact.force.z, 0.01F);
    rig.rest(10);
    EXPECT_EQ(rig.force().norm(), 0.0);
    rig.go({0.0, 0.0, 0.002});
    EXPECT_LT(rig.force().z(), -0.7);
  }
}

TEST(SceneFade, ResetsForcesButNotBodies) {
  SceneRig rig = pressed();
  ASSERT_EQ(rig.scene.enable(0, false), ModelStatus::kOk);
  rig.rest(1);
  rig.scene.reset({});
  rig.rest(1);
  EXPECT_EQ(rig.force().norm(), 0.0);
  EXPECT_FALSE(rig.scene.empty());
  rig = pressed();
  rig.scene.clear();
  rig.rest(1);
  EXPECT_EQ(rig.force().norm(), 0.0);
  EXPECT_TRUE(rig.scene.empty());
}

TEST(SceneFade, KeepsDurationAtEveryRate) {
  for (const float rate_hz : {500.0F, 4000.0F}) {
    SceneRig rig = pressed();
    rig.configuration.rate_hz = rate_hz;
    rig.rest(1);
    ASSERT_EQ(rig.scene.remove(0), ModelStatus::kOk);
    const auto ticks = static_cast<int>(std::lround(0.05F * rate_hz));
    rig.rest(ticks - 1);
    EXPECT_GT(rig.force().norm(), 0.0);
    rig.rest(1);
    EXPECT_EQ(rig.force().norm(), 0.0);
  }
}

}  // namespace
}  // namespace tactree::test
