// Bodies wherever they are: the same forces as at the origin, pushed and dragged by what moves, and
// as much force on each body as on the hand.

#include "tactree/core/contact/scene.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "scene_rig.hpp"

namespace tactree::test {
namespace {

constexpr double kStep = 5e-3;   // m, between the treads of high_step()
constexpr double kDepth = 1e-3;  // m, of the hand below the lower tread

using core::kMaxBodies;
using core::kMaxReachableBodies;
using core::kNoBody;
using core::ModelStatus;
using core::Motion;
using core::Pose;
using core::Reaction;
using core::SceneRendering;

const Eigen::Isometry3d kHere = Eigen::Isometry3d::Identity();
/// Where the sheet is a wall x = 0 with its outside towards +x.
const Eigen::Isometry3d kWallX = isometry({0.0, 0.0, 0.0}, {0.0, std::numbers::pi / 2.0, 0.0});

core::Configuration rough_wall() {
  core::Configuration c = smooth_wall();
  c.contact.damping_Ns_m = 0.5F;
  c.contact.static_friction = 0.6F;
  c.contact.dynamic_friction = 0.5F;
  return c;
}

Eigen::Vector3d force_on(const SceneRendering& r, std::uint32_t body) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Reaction& reaction : r.reactions) {
    sum += reaction.body == body ? widen(reaction.force_N) : Eigen::Vector3d::Zero();
  }
  return sum;
}

Eigen::Vector3d force_on_all(const SceneRendering& r) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Reaction& reaction : r.reactions) {
    sum += widen(reaction.force_N);
  }
  return sum;
}

// The same touch of the same body at rest somewhere else gives the same force, turned along.
TEST(Scene, RendersForceIndependentOfPose) {
  const Shape shape = cos_sheet();
  RandomPoses random(4);
  for (int i = 0; i < 20; ++i) {
    const Eigen::Isometry3d pose = random.pose(0.5);
    SceneRig at_origin(rough_wall());
    SceneRig elsewhere(rough_wall());
    at_origin.add(shape);
    elsewhere.add(shape, pose);
    const Eigen::Vector3d touched = random.vector(0.02);
    const double z = CosSheet{}.height(touched.x(), touched.y());
    int contacts = 0;
    for (int tick = 0; tick < 200; ++tick) {  // down, and then along
      const Eigen::Vector3d probe(touched.x() + 5e-5 * std::max(0, tick - 100), touched.y(),
                                  z + 3e-3 - 5e-5 * std::min(tick, 100));
      at_origin.tick(probe);
      elsewhere.tick(pose * probe);
      ASSERT_EQ(at_origin.last.contact.in_contact, elsewhere.last.contact.in_contact);
      ASSERT_LT((pose.linear() * at_origin.force() - elsewhere.force()).norm(), 2e-3);
      ASSERT_LT(
          (pose * widen(at_origin.last.contact.proxy) - widen(elsewhere.last.contact.proxy)).norm(),
          2e-6);
      ASSERT_LT((pose.linear() * widen(at_origin.last.contact.normal) -
                 widen(elsewhere.last.contact.normal))
                    .norm(),
                2e-3);
      contacts += at_origin.last.contact.in_contact ? 1 : 0;
    }
    EXPECT_GT(contacts, 120);
  }
}

TEST(Scene, PushesRestingProbe) {
  for (const double speed : {0.01, 0.1, 0.5}) {
    SceneRig rig;
    const std::uint32_t body = rig.add(sheet(), isometry({0.0, 0.0, -0.005}));
    rig.tick({0.0, 0.0, 0.0});
    ASSERT_EQ(rig.scene.move(body, rig.scene.pose(body), {{0, 0, static_cast<float>(speed)}, {}}),
              ModelStatus::kOk);
    double overlap = -0.005;
    for (; overlap < 2e-3; overlap += speed * kTick) {  // the move holds from the next tick on
      rig.rest(1);
      ASSERT_NEAR(rig.force().z(), kWall * std::max(0.0, overlap), 0.01) << speed;
      ASSERT_NEAR(rig.force().head<2>().norm(), 0.0, 1e-3);
    }
    EXPECT_TRUE(rig.last.contact.in_contact);
    EXPECT_NEAR(static_cast<double>(rig.last.wall_velocity.z), speed, 1e-6);
  }
}

TEST(Scene, DampsMovingBodyLikeProbe) {
  core::Configuration damped = smooth_wall();
  damped.contact.damping_Ns_m = 2.0F;
  SceneRig rig(damped);
  const std::uint32_t body = rig.add(sheet(), isometry({0.0, 0.0, -1e-3}));
  rig.tick({0.0, 0.0, 0.0});
  ASSERT_EQ(rig.scene.move(body, rig.scene.pose(body), {{0.0F, 0.0F, 0.1F}, {}}), ModelStatus::kOk);
  rig.rest(31);  // 2 mm
  EXPECT_NEAR(rig.force().z(), kWall * 2e-3 + 2.0 * 0.1, 0.01);
}

TEST(Scene, CarriesProxyWithBody) {
  SceneRig rig(rough_wall());
  const std::uint32_t body = rig.add(sheet());
  rig.tick({0.0, 0.0, 0.002});
  rig.go({0.0, 0.0, -0.002});
  ASSERT_EQ(rig.scene.move(body, {}, {{0.01F, 0.0F, 0.0F}, {}}), ModelStatus::kOk);
  rig.rest(51);  // half a millimetre sideways, within the cone of friction
  EXPECT_FALSE(rig.last.contact.slipping);
  EXPECT_NEAR(static_cast<double>(rig.last.contact.proxy.x), 0.5e-3, 1e-6);
  EXPECT_NEAR(rig.force().x(), kWall * 0.5e-3 + 0.5 * 0.01, 0.01);
  EXPECT_NEAR(rig.force().z(), kWall * 2e-3, 0.01);
}

// A ball that turns under a resting probe rubs on it as a probe would that moves over the ball.
TEST(Scene, DragsProbeWithRotatingBody) {
  const Shape ball = sphere();
  SceneRig rig(rough_wall());
  rig.configuration.contact.damping_Ns_m = 0.0F;
  const std::uint32_t body = rig.add(ball);
  rig.tick({0.0, 0.0, kSphereRadius + 0.002});
  rig.go({0.0, 0.0, kSphereRadius - 0.002});
  ASSERT_EQ(rig.scene.move(body, {}, {{}, {2.0F, 0.0F, 0.0F}}), ModelStatus::kOk);
  rig.rest(200);
  EXPECT_TRUE(rig.last.contact.slipping);
  const Eigen::Vector3d normal = widen(rig.last.contact.normal);
  const double push = rig.force().dot(normal);
  const Eigen::Vector3d drag = rig.force() - push * normal;
  EXPECT_NEAR(drag.norm() / push, 0.5, 0.01);  // dynamic friction
  EXPECT_LT(drag.y(), -0.99 * drag.norm());
  const double lever = kSphereRadius - 0.002;
  EXPECT_NEAR(static_cast<double>(rig.last.wall_velocity.y), -2.0 * lever, 1e-4);
}

// The line of a spring's force goes through the probe: so the torque is known without the proxy.
TEST(Scene, ReportsOppositeReaction) {
  RandomPoses random(5);
  for (int i = 0; i < 20; ++i) {
    const Eigen::Isometry3d pose = random.pose(0.5);
    core::Configuration sticky = smooth_wall();
    sticky.contact.static_friction = sticky.contact.dynamic_friction = 0.8F;
    SceneRig rig(sticky);
    rig.add(sheet(), kFar);
    const std::uint32_t body = rig.add(sheet(), pose);
    rig.tick(pose * Eigen::Vector3d(0.010, 0.005, 0.002));
    rig.go(pose * Eigen::Vector3d(0.010, 0.005, -0.002));
    rig.go(pose * Eigen::Vector3d(0.0105, 0.0055, -0.002));
    ASSERT_EQ(rig.last.contact.body, body);
    ASSERT_GT(rig.force().norm(), 0.9);
    const auto& reactions = rig.last.reactions;
    const Reaction& reaction = reactions[reactions[0].body == body ? 0 : 1];
    ASSERT_EQ(reaction.body, body);
    EXPECT_LT((widen(reaction.force_N) + rig.force()).norm(), 1e-6);
    const Eigen::Vector3d arm = rig.at() - pose.translation();
    EXPECT_LT((widen(reaction.torque_Nm) - arm.cross(-rig.force())).norm(), 1e-6);
    EXPECT_GT(widen(reaction.torque_Nm).norm(), 1e-3);
  }
}

TEST(Scene, SharesForceAmongHoldingBodies) {
  SceneRig rig;
  const std::uint32_t floor = rig.add(sheet());
  const std::uint32_t wall = rig.add(sheet(), kWallX);
  rig.tick({0.005, 0.0, 0.005});
  rig.go({-0.001, 0.0, -0.002});
  EXPECT_LT((rig.force() - kWall * Eigen::Vector3d(0.001, 0.0, 0.002)).norm(), 0.01);
  EXPECT_LT((force_on(rig.last, floor) + kWall * Eigen::Vector3d(0.0, 0.0, 0.002)).norm(), 0.01);
  EXPECT_LT((force_on(rig.last, wall) + kWall * Eigen::Vector3d(0.001, 0.0, 0.0)).norm(), 0.01);
  EXPECT_LT((force_on_all(rig.last) + rig.force()).norm(), 1e-6);
  EXPECT_EQ(rig.last.contact.body, floor);  // reached first
  const double energy = 0.5 * kWall * (0.001 * 0.001 + 0.002 * 0.002);
  EXPECT_NEAR(static_cast<double>(rig.last.contact.stored_energy), energy, 0.01 * energy);
  EXPECT_FALSE(rig.last.crowded);
}

/// Two treads, 5 mm apart, with the riser between them; they rise towards -x.
Shape high_step() {
  Shape shape;
  const int width = 20;
  for (int j = -width; j < width; ++j) {
    const double y = (j + 0.5) * kSpacing;
    for (int i = 0; i < width; ++i) {
      const double along = (i + 0.5) * kSpacing;
      shape.add({-along, y, kStep}, Eigen::Vector3d::UnitZ());
      shape.add({along, y, 0.0}, Eigen::Vector3d::UnitZ());
      if (along < kStep) {
        shape.add({0.0, y, along}, Eigen::Vector3d::UnitX());
      }
    }
  }
  shape.seal();
  return shape;
}

// The proxy needs two ticks from the edge to the lower tread.
TEST(Scene, KeepsForceWhileProxyFalls) {
  const Shape shape = high_step();
  SceneRig rig;
  rig.add(shape);
  rig.go({-0.004, 0.3e-3, kStep + 2e-3});
  rig.go({-0.004, 0.3e-3, -kDepth});
  EXPECT_NEAR(rig.force().z(), kWall * (kStep + kDepth), 0.01);
  for (double x = -0.004; x < 0.004; x += 1e-4) {
    rig.tick({x, 0.3e-3, -kDepth});
    EXPECT_GE(rig.force().norm(), kWall * kDepth - 0.01) << x;
  }
  EXPECT_NEAR(rig.force().z(), kWall * kDepth, 0.01);
}

// Above the lower tread, the same hand is outside: the force only decreases, and never pulls.
TEST(Scene, EndsForceWhereProxyFallsToProbe) {
  const Shape shape = high_step();
  SceneRig rig;
  rig.add(shape);
  rig.go({-0.002, 0.3e-3, kStep + 2e-3});
  rig.go({-0.002, 0.3e-3, 0.003});
  double last = rig.force().norm();
  for (double x = -0.002; x < 0.004; x += 1e-4) {
    rig.tick({x, 0.3e-3, 0.003});
    EXPECT_LE(rig.force().norm(), last + 0.06) << x;
    EXPECT_GE(rig.force().z(), -1e-6) << x;
    last = rig.force().norm();
  }
  EXPECT_EQ(last, 0.0);
  EXPECT_FALSE(rig.last.contact.in_contact);
}

TEST(Scene, IgnoresBodiesOutOfReach) {
  SceneRig alone(rough_wall());
  SceneRig among_others(rough_wall());
  alone.add(sheet());
  among_others.add(sheet());
  for (std::uint32_t i = 1; i < kMaxBodies; ++i) {
    among_others.add(sheet(), kFar);
  }
  for (SceneRig* rig : {&alone, &among_others}) {
    rig->tick({0.0, 0.0, 0.002});
    rig->go({0.0, 0.001, -0.001});
  }
  EXPECT_GT(alone.force().norm(), 0.4);
  EXPECT_EQ(alone.last.contact.force, among_others.last.contact.force);
  EXPECT_EQ(alone.last.contact.proxy, among_others.last.contact.proxy);
}

TEST(Scene, RendersBodiesReachedFirst) {
  SceneRig rig;
  const std::uint32_t late = rig.add(sheet(), kFar);
  const std::uint32_t floor = rig.add(sheet());
  const std::uint32_t wall = rig.add(sheet(), kWallX);
  rig.tick({0.005, 0.0, 0.005});
  rig.go({-0.001, 0.0, -0.001});
  EXPECT_FALSE(rig.last.crowded);
  ASSERT_EQ(rig.scene.move(late, to_core(isometry({0.0, 0.0, 0.0005})), {}), ModelStatus::kOk);
  rig.go({-0.001, 0.0, -0.0015});
  EXPECT_TRUE(rig.last.crowded);
  EXPECT_LT((rig.force() - kWall * Eigen::Vector3d(1e-3, 0.0, 1.5e-3)).norm(), 0.01);
  EXPECT_EQ(force_on(rig.last, late).norm(), 0.0);

  // When there is room again the third is felt too, but only when the probe has come to it.
  rig.go({0.005, 0.0, 0.02});
  EXPECT_FALSE(rig.last.crowded);
  ASSERT_EQ(rig.scene.enable(floor, false), ModelStatus::kOk);
  rig.go({-0.001, 0.0, -0.0015});
  EXPECT_NEAR(force_on(rig.last, late).z(), -kWall * 2e-3, 0.01);
  EXPECT_NEAR(force_on(rig.last, wall).x(), -kWall * 1e-3, 0.01);
}

TEST(Scene, RendersLowestNumbersOnTie) {
  SceneRig rig;
  for (std::uint32_t i = 0; i <= kMaxReachableBodies; ++i) {
    rig.add(sheet());
  }
  rig.tick({0.0, 0.0, 0.02});
  rig.go({0.0, 0.0, -0.001});
  EXPECT_TRUE(rig.last.crowded);
  EXPECT_NEAR(rig.force().z(), kWall * 1e-3, 0.01);  // bodies in the same place are one
  EXPECT_EQ(force_on(rig.last, kMaxReachableBodies).norm(), 0.0);
}

// Deep below a sheet the probe is out of its reach, and yet held by it.
TEST(Scene, KeepsSlotDuringContact) {
  SceneRig rig;
  const std::uint32_t held = rig.add(sheet());
  rig.add(sheet(), isometry({0.0, 0.0, -0.0120}));
  const std::uint32_t third = rig.add(sheet(), isometry({0.0, 0.0, -0.0125}));
  rig.tick({0.0, 0.0, 0.002});
  rig.go({0.0, 0.0, -0.0135});
  EXPECT_TRUE(rig.last.crowded);
  EXPECT_NEAR(force_on(rig.last, held).z(), -kWall * 13.5e-3, 0.01);
  EXPECT_EQ(force_on(rig.last, third).norm(), 0.0);
  EXPECT_NEAR(rig.force().z(), kWall * 13.5e-3, 0.01);  // the others are behind the first one
}

/// A sheet that goes by a resting probe, from -2 cm to +4 cm: is it felt? The proxy follows a sheet
/// of 9 m/s with a delay.
/// Two others, far away, are nearer to being rendered.
bool notices_passing(const Eigen::Isometry3d& turned, const Eigen::Vector3d& normal, double speed,
                     double phase) {
  SceneRig rig;
  rig.add(sheet(), kFar);
  rig.add(sheet(), kFar);
  Eigen::Isometry3d begin = turned;
  begin.pretranslate((-0.02 + phase * speed * kTick) * normal);
  const std::uint32_t body = rig.add(sheet(), begin);
  rig.tick({0.0, 0.0, 0.0});
  const Motion motion{narrow(speed * normal), {}};
  EXPECT_EQ(rig.scene.move(body, rig.scene.pose(body), motion), ModelStatus::kOk);
  for (double travel = -0.02; travel < 0.04; travel += speed * kTick) {
    if (rig.rest(1).contact.in_contact) {
      return true;
    }
  }
  return false;
}

TEST(Scene, DetectsFastPassingBody) {
  RandomPoses random(6);
  int missed = 0;
  for (const double speed : {0.1, 1.0, 3.0, 5.0, 9.0}) {
    for (int i = 0; i < 50; ++i) {
      const Eigen::Isometry3d turned = isometry({0.0, 0.0, 0.0}, random.vector(3.0));
      const double side = i % 2 == 0 ? 1.0 : -1.0;
      const Eigen::Vector3d normal = side * turned.linear().col(2);
      missed += notices_passing(turned, normal, speed, random.vector(0.5).x() + 0.5) ? 0 : 1;
    }
  }
  EXPECT_EQ(missed, 0);
}

/// The sheet, 10 cm from its origin.
Shape flap_on_a_hinge() {
  Shape shape;
  for (double x = 0.08; x <= 0.12; x += kSpacing) {
    for (double y = -0.02; y <= 0.02; y += kSpacing) {
      shape.add({x, y, 0.0}, Eigen::Vector3d::UnitZ());
    }
  }
  shape.seal();
  return shape;
}

// A flap that turns about a far hinge comes as fast as its lever is long.
TEST(Scene, DetectsSwingingBody) {
  for (const float turn : {1.0F, 5.0F, 20.0F}) {
    SceneRig rig;
    const Shape flap = flap_on_a_hinge();
    const std::uint32_t body = rig.add(flap);
    rig.tick({0.0, 0.0, 0.1});
    ASSERT_EQ(rig.scene.move(body, {}, {{}, {0.0F, -turn, 0.0F}}), ModelStatus::kOk);
    bool felt = false;
    for (int i = 0; i < 2000 && !felt; ++i) {
      felt = rig.rest(1).contact.in_contact;
    }
    EXPECT_TRUE(felt) << turn;
  }
}

// A rotation that is a little too long would make the body as much larger or smaller.
TEST(Scene, NormalisesRotations) {
  const Pose longer{{1.0004F, {}}, {}};
  SceneRig rig;
  std::uint32_t body = 0;
  ASSERT_EQ(rig.scene.add(sheet().view(), longer, body), ModelStatus::kOk);
  EXPECT_EQ(rig.scene.pose(body), Pose{});
  ASSERT_EQ(rig.scene.move(body, longer, {}), ModelStatus::kOk);
  EXPECT_EQ(rig.scene.pose(body), Pose{});
}

TEST(Scene, MovesBodyUntilNextCommand) {
  SceneRig rig;
  const std::uint32_t body = rig.add(sheet(), kFar);
  ASSERT_EQ(rig.scene.move(body, {}, {{0.0F, 0.1F, 0.0F}, {0.0F, 0.0F, 1.0F}}), ModelStatus::kOk);
  rig.tick({1.0, 0.0, 0.0});
  rig.rest(99);
  EXPECT_NEAR(rig.scene.pose(body).translation_m.y, 0.01F, 1e-6F);
  EXPECT_NEAR(rig.scene.pose(body).rotation.v.z, std::sin(0.05F), 1e-5F);
  ASSERT_EQ(rig.scene.enable(body, false), ModelStatus::kOk);
  rig.rest(100);
  EXPECT_NEAR(rig.scene.pose(body).translation_m.y, 0.02F, 1e-6F);
  ASSERT_EQ(rig.scene.move(body, rig.scene.pose(body), {}), ModelStatus::kOk);
  rig.rest(100);
  EXPECT_NEAR(rig.scene.pose(body).translation_m.y, 0.02F, 1e-6F);
}

TEST(Scene, RefusesInvalidCommandsWithoutEffect) {
  SceneRig rig;
  Pose bent;
  bent.rotation.w = 0.9F;
  std::uint32_t number = 77;
  EXPECT_EQ(rig.scene.add({}, {}, number), ModelStatus::kEmpty);
  EXPECT_EQ(rig.scene.add(sheet().view(), bent, number), ModelStatus::kBadPose);
  EXPECT_EQ(number, 77U);
  EXPECT_TRUE(rig.scene.empty());
  const std::uint32_t body = rig.add(sheet(), kFar);
  const Pose before = rig.scene.pose(body);
  EXPECT_EQ(rig.scene.move(body, bent, {}), ModelStatus::kBadPose);
  EXPECT_EQ(rig.scene.move(body, {}, {{11.0F, 0.0F, 0.0F}, {}}), ModelStatus::kBadMotion);
  EXPECT_EQ(rig.scene.pose(body), before);
  for (const std::uint32_t nobody : {body + 1, kMaxBodies, kNoBody}) {
    EXPECT_EQ(rig.scene.move(nobody, {}, {}), ModelStatus::kNoSuchBody);
    EXPECT_EQ(rig.scene.enable(nobody, true), ModelStatus::kNoSuchBody);
    EXPECT_EQ(rig.scene.remove(nobody), ModelStatus::kNoSuchBody);
    EXPECT_TRUE(rig.scene.view(nobody).empty());
  }
}

TEST(Scene, ReusesNumbersOfRemovedBodies) {
  SceneRig rig;
  for (std::uint32_t i = 0; i < kMaxBodies; ++i) {
    EXPECT_EQ(rig.add(sheet(), kFar), i);
  }
  rig.add(sheet());
  EXPECT_EQ(rig.status, ModelStatus::kTooManyBodies);
  ASSERT_EQ(rig.scene.move(3, to_core(kFar), {{0.0F, 1.0F, 0.0F}, {}}), ModelStatus::kOk);
  ASSERT_EQ(rig.scene.enable(3, false), ModelStatus::kOk);
  ASSERT_EQ(rig.scene.remove(3), ModelStatus::kOk);
  EXPECT_EQ(rig.scene.remove(3), ModelStatus::kNoSuchBody);
  EXPECT_EQ(rig.add(sheet()), 3U);
  EXPECT_EQ(rig.status, ModelStatus::kOk);
  rig.tick({0.0, 0.0, 0.01});
  rig.go({0.0, 0.0, -0.001});
  EXPECT_EQ(rig.scene.pose(3), Pose{});  // at rest
  EXPECT_NEAR(force_on(rig.last, 3).z(), -kWall * 1e-3, 0.01);
}

TEST(Scene, DescribesEveryStatusUniquely) {
  std::vector<std::string> words;
  for (int i = 0; i <= static_cast<int>(ModelStatus::kBadMotion); ++i) {
    words.emplace_back(core::describe(static_cast<ModelStatus>(i)));
  }
  std::sort(words.begin(), words.end());
  EXPECT_EQ(std::unique(words.begin(), words.end()), words.end());
  EXPECT_STREQ(core::describe(ModelStatus::kBadMotion),
               "the motion is not finite, or beyond 10 m/s or 100 rad/s");
  EXPECT_STREQ(core::describe(static_cast<ModelStatus>(99)), "unknown status");
}

}  // namespace
}  // namespace tactree::test
