// Bodies around a hand: no force until it has left them.

#include <gtest/gtest.h>

#include "scene_rig.hpp"

namespace tactree::test {
namespace {

const Shape& ball() {
  static const Shape shape = sphere(0.015);
  return shape;
}

const Eigen::Vector3d kInBall{0.0, 0.0, 0.012};
const Eigen::Vector3d kAbove{0.0, 0.0, 0.03};

/// Out of the ball without a force, and back onto it.
void expect_free_then_felt(SceneRig& rig) {
  rig.rest(2);
  EXPECT_TRUE(rig.last.inside);
  EXPECT_EQ(rig.force().norm(), 0.0);
  double most = 0.0;
  while (rig.at().z() < 0.02) {
    rig.tick(rig.at() + Eigen::Vector3d(0.0, 0.0, 1e-4));
    most = std::max(most, rig.force().norm());
  }
  EXPECT_EQ(most, 0.0);
  EXPECT_FALSE(rig.last.inside);
  rig.go({0.0, 0.0, 0.014});
  EXPECT_GT(rig.force().z(), 0.4);
  EXPECT_FALSE(rig.last.inside);
}

TEST(SceneInside, LeavesAddedBodyWithoutForce) {
  SceneRig rig;
  rig.add(ball(), isometry({0.0, 0.0, -1.0}));
  rig.go(kInBall);
  EXPECT_FALSE(rig.last.inside);
  rig.add(ball());
  expect_free_then_felt(rig);
}

TEST(SceneInside, LeavesEnabledBodyWithoutForce) {
  SceneRig rig;
  rig.add(ball());
  ASSERT_EQ(rig.scene.enable(0, false), core::ModelStatus::kOk);
  rig.tick(kAbove);
  rig.go(kInBall);
  EXPECT_FALSE(rig.last.inside) << "a disabled body is not there";
  ASSERT_EQ(rig.scene.enable(0, true), core::ModelStatus::kOk);
  expect_free_then_felt(rig);
}

TEST(SceneInside, LeavesJumpingBodyWithoutForce) {
  SceneRig rig;
  rig.add(ball(), isometry({0.1, 0.0, 0.0}));
  rig.tick(kInBall);
  ASSERT_EQ(rig.scene.move(0, {}, {}), core::ModelStatus::kOk);
  expect_free_then_felt(rig);
}

TEST(SceneInside, LeavesInitialBodyWithoutForce) {
  SceneRig rig;
  rig.add(ball());
  rig.tick(kInBall);
  expect_free_then_felt(rig);
}

// Another body is felt meanwhile.
TEST(SceneInside, RendersOtherBodyWhileInside) {
  SceneRig rig;
  rig.add(ball());
  rig.add(sheet(), isometry({0.0, 0.0, 0.011}));
  rig.tick(kInBall);
  rig.go({0.0, 0.0, 0.0105});
  EXPECT_TRUE(rig.last.inside);
  EXPECT_NEAR(rig.force().z(), 0.5e-3 * kWall, 0.02);
}

TEST(SceneInside, MovesInteriorWithBody) {
  SceneRig rig;
  const Eigen::Isometry3d turned = isometry({0.02, 0.01, 0.0}, {0.3, 0.6, 0.15});
  rig.add(ball(), turned);
  rig.tick({0.02, 0.01, 0.013});
  core::Motion motion;
  motion.linear_m_s = {0.05F, 0.0F, 0.0F};
  ASSERT_EQ(rig.scene.move(0, core::normalized(to_core(turned)), motion), core::ModelStatus::kOk);
  double most = 0.0;
  int inside = 0;
  for (int i = 0; i < 800; ++i) {  // it goes on by 40 mm
    rig.rest(1);
    most = std::max(most, rig.force().norm());
    inside += rig.last.inside ? 1 : 0;
  }
  EXPECT_EQ(most, 0.0);
  EXPECT_NEAR(inside, 150, 10);  // 7.5 mm
  EXPECT_FALSE(rig.last.inside);
}

}  // namespace
}  // namespace tactree::test
