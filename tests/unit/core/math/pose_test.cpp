// Poses turn and move as Eigen's do in double precision, and stay rotations.

#include "tactree/core/math/pose.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <limits>

#include "poses.hpp"

namespace tactree::test {
namespace {

using core::Motion;
using core::Pose;
using core::Vec3;

double length_of(core::Quaternion q) {
  const double w = static_cast<double>(q.w);
  return std::sqrt(w * w + widen(q.v).squaredNorm());
}

TEST(Pose, AgreesWithEigen) {
  RandomPoses random(1);
  for (int i = 0; i < 1000; ++i) {
    const Eigen::Isometry3d pose = random.pose(1.0);
    const Pose of_core = core::normalized(to_core(pose));
    const Eigen::Vector3d p = random.vector(1.0);
    const Vec3 in_scene = core::position_to_scene(of_core, narrow(p));
    EXPECT_LT((widen(in_scene) - pose * p).norm(), 2e-6);
    EXPECT_LT((widen(core::position_to_body(of_core, in_scene)) - p).norm(), 2e-6);
    const Vec3 turned = core::direction_to_body(of_core, narrow(p));
    EXPECT_LT((pose.linear() * widen(turned) - p).norm(), 2e-6);
  }
}

TEST(Pose, KeepsBitsUnderIdentity) {
  const Vec3 odd{-0.0F, 1e-42F, -1.0e30F};
  const auto same = [&odd](Vec3 v) {
    return std::bit_cast<std::uint32_t>(v.x) == std::bit_cast<std::uint32_t>(odd.x) &&
           v.y == odd.y && v.z == odd.z;
  };
  EXPECT_TRUE(same(core::position_to_body({}, odd)));
  EXPECT_TRUE(same(core::position_to_scene({}, odd)));
  EXPECT_TRUE(same(core::direction_to_body({}, odd)));
  EXPECT_TRUE(same(core::relative_velocity({}, {}, {1.0F, 2.0F, 3.0F}, odd)));
}

/// Each number of a pose or motion in turn replaced by something that is refused.
template <class Value>
void expect_each_number_refused(Value value, std::initializer_list<float> bad) {
  constexpr std::size_t kCount = sizeof(Value) / sizeof(float);
  ASSERT_TRUE(core::is_valid(value));
  for (std::size_t i = 0; i < kCount; ++i) {
    for (const float number : bad) {
      auto numbers = std::bit_cast<std::array<float, kCount>>(value);
      numbers[i] = number;
      EXPECT_FALSE(core::is_valid(std::bit_cast<Value>(numbers))) << i << ": " << number;
    }
  }
}

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

TEST(Pose, RefusesInvalidRotationsAndDistances) {
  expect_each_number_refused(Pose{}, {kNan, kInfinity, -kInfinity, 10.001F, -10.001F});
  EXPECT_TRUE(core::is_valid(Pose{{}, {10.0F, -10.0F, 10.0F}}));
  for (const float w : {0.0F, 0.998F, 1.001F, -0.998F}) {
    EXPECT_FALSE(core::is_valid(Pose{{w, {}}, {}})) << w;
  }
  for (const float w : {0.9996F, 1.0004F, -1.0F}) {
    EXPECT_TRUE(core::is_valid(Pose{{w, {}}, {}})) << w;
  }
}

TEST(Motion, RefusesExcessiveSpeeds) {
  expect_each_number_refused(Motion{}, {kNan, kInfinity, -kInfinity, 100.01F, -100.01F});
  EXPECT_TRUE(core::is_valid(Motion{{10.0F, -10.0F, 10.0F}, {100.0F, -100.0F, 100.0F}}));
  EXPECT_FALSE(core::is_valid(Motion{{10.01F, 0.0F, 0.0F}, {}}));
}

TEST(Pose, NormalisesToUnitQuaternion) {
  RandomPoses random(2);
  for (const double length : {0.9996, 0.9999, 1.0001, 1.0004}) {
    for (int i = 0; i < 100; ++i) {
      const Eigen::Quaterniond unit(random.pose(1.0).linear());
      const Pose pose{{static_cast<float>(length * unit.w()), narrow(length * unit.vec())}, {}};
      ASSERT_TRUE(core::is_valid(pose));
      const Pose normal = core::normalized(pose);
      EXPECT_NEAR(length_of(normal.rotation), 1.0, 1.5e-7);
      EXPECT_LT(unit.angularDistance(Eigen::Quaterniond(to_eigen(normal).linear())), 1e-6);
    }
  }
}

TEST(Pose, StaysNormalisedOverMillionTicks) {
  Pose pose = core::normalized(to_core(isometry({0.1, 0.2, 0.3}, {1.0, -2.0, 0.5})));
  const Motion motion{{}, {30.0F, -70.0F, 11.0F}};
  double furthest = 0.0;
  for (int i = 0; i < 1'000'000; ++i) {
    pose = core::advanced(pose, motion, 1e-3F);
    furthest = std::max(furthest, std::abs(length_of(pose.rotation) - 1.0));
  }
  EXPECT_LT(furthest, 3e-7);
  EXPECT_TRUE(core::is_valid(pose));
  EXPECT_EQ(pose.translation_m, (Vec3{0.1F, 0.2F, 0.3F}));
}

TEST(Pose, AdvancesByMotion) {
  const Eigen::Vector3d axis = Eigen::Vector3d(1.0, 2.0, -2.0).normalized();
  const Eigen::Isometry3d begin = isometry({0.1, 0.0, 0.0}, {0.3, 0.4, 0.5});
  Pose pose = core::normalized(to_core(begin));
  const Motion motion{{0.2F, -0.1F, 0.3F}, narrow(10.0 * axis)};
  for (int i = 0; i < 1000; ++i) {
    pose = core::advanced(pose, motion, 1e-3F);
  }
  const Eigen::Quaterniond expected(Eigen::AngleAxisd(10.0, axis) * begin.linear());
  const Eigen::Quaterniond found(to_eigen(pose).linear());
  EXPECT_LT(expected.angularDistance(found), 1000 * 1e-7);
  EXPECT_LT((widen(pose.translation_m) - Eigen::Vector3d(0.3, -0.1, 0.3)).norm(), 2e-5);
}

TEST(Pose, StopsAtTranslationLimit) {
  Pose pose{{}, {9.995F, 0.0F, 0.0F}};
  for (int i = 0; i < 100; ++i) {
    pose = core::advanced(pose, {{1.0F, 1.0F, 0.0F}, {}}, 1e-3F);
    ASSERT_TRUE(core::is_valid(pose));
  }
  EXPECT_GT(pose.translation_m.x, 9.998F);
}

TEST(Pose, MatchesNumericRelativeVelocity) {
  RandomPoses random(3);
  for (int i = 0; i < 100; ++i) {
    const Eigen::Isometry3d pose = random.pose(0.5);
    const Eigen::Vector3d p = random.vector(0.5);
    const Eigen::Vector3d velocity = random.vector(1.0);
    const Eigen::Vector3d linear = random.vector(1.0);
    const Eigen::Vector3d angular = random.vector(10.0);
    constexpr double kStep = 1e-6;
    const auto in_body = [&](double t) -> Eigen::Vector3d {
      Eigen::Isometry3d then = isometry(pose.translation() + t * linear, t * angular);
      then.linear() = then.linear() * pose.linear();
      return then.inverse() * (p + t * velocity);
    };
    const Eigen::Vector3d expected =
        pose.linear() * (in_body(kStep) - in_body(-kStep)) / (2.0 * kStep);
    const Vec3 found = core::relative_velocity(to_core(pose), {narrow(linear), narrow(angular)},
                                               narrow(p), narrow(velocity));
    EXPECT_LT((widen(found) - expected).norm(), 1e-5);
  }
}

}  // namespace
}  // namespace tactree::test
