// Poses of a body follow its keyframes, and the reported motion matches them.

#include "tactree/simulation/body_path.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>
#include <vector>

#include "poses.hpp"

namespace tactree::test {
namespace {

using simulation::BodyPath;
using simulation::Keyframe;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

void expect_near(const core::Pose& found, const Eigen::Isometry3d& expected) {
  const Eigen::Isometry3d pose = to_eigen(found);
  EXPECT_LT((pose.translation() - expected.translation()).norm(), 1e-6);
  EXPECT_LT((pose.linear() - expected.linear()).norm(), 2e-6);
}

std::vector<Keyframe> random_keyframes(RandomPoses& random) {
  return {{-0.5, random.pose(0.3)}, {0.25, random.pose(0.3)}, {2.0, random.pose(0.3)}};
}

TEST(BodyPath, PassesKeyframesRestingAtEnds) {
  RandomPoses random(8);
  for (int i = 0; i < 50; ++i) {
    const std::vector<Keyframe> keyframes = random_keyframes(random);
    const BodyPath path(keyframes);
    for (const Keyframe& keyframe : keyframes) {
      expect_near(path.at(keyframe.t_s).pose, keyframe.pose);
      expect_near(path.at(keyframe.t_s - 1e-9).pose, keyframe.pose);
    }
    for (const double t_s : {-100.0, -0.5 - 1e-9, 2.0, 100.0}) {
      EXPECT_EQ(path.at(t_s).motion, core::Motion{});
      expect_near(path.at(t_s).pose, keyframes[t_s < 0.0 ? 0 : 2].pose);
    }
    EXPECT_EQ(path.first().matrix(), keyframes[0].pose.matrix());
  }
}

/// The path's own motion against the difference of two of its poses.
void expect_motion_of_poses(const BodyPath& path, double t_s) {
  constexpr double kStep = 1e-2;
  const Eigen::Isometry3d before = to_eigen(path.at(t_s - kStep).pose);
  const Eigen::Isometry3d after = to_eigen(path.at(t_s + kStep).pose);
  const core::Motion motion = path.at(t_s).motion;
  const Eigen::Vector3d linear = (after.translation() - before.translation()) / (2.0 * kStep);
  EXPECT_LT((widen(motion.linear_m_s) - linear).norm(), 1e-5);
  const Eigen::AngleAxisd turn(Eigen::Matrix3d(after.linear() * before.linear().transpose()));
  const Eigen::Vector3d angular = turn.angle() / (2.0 * kStep) * turn.axis();
  EXPECT_LT((widen(motion.angular_rad_s) - angular).norm(), 1e-4);
}

TEST(BodyPath, MotionIsPoseDerivative) {
  RandomPoses random(9);
  for (int i = 0; i < 50; ++i) {
    const BodyPath keyframes(random_keyframes(random));
    const BodyPath constant(random.pose(0.3), random.vector(1.0), random.vector(5.0));
    for (const double t_s : {-0.3, 0.1, 0.3, 1.9}) {
      expect_motion_of_poses(keyframes, t_s);
      if (t_s > 0.0) {
        expect_motion_of_poses(constant, t_s);
      }
    }
  }
}

TEST(BodyPath, ConstantVelocityStartsAtZero) {
  const Eigen::Isometry3d begin = isometry({0.1, 0.2, 0.3}, {0.0, 0.0, 1.0});
  const BodyPath path(begin, {0.01, 0.0, -0.02}, {0.0, 2.0, 0.0});
  for (const double t_s : {-5.0, -1e-3, 0.0}) {
    expect_near(path.at(t_s).pose, begin);
  }
  EXPECT_EQ(path.at(-1e-3).motion, core::Motion{});
  EXPECT_EQ(path.at(0.0).motion, (core::Motion{{0.01F, 0.0F, -0.02F}, {0.0F, 2.0F, 0.0F}}));
  Eigen::Isometry3d later = isometry({0.13, 0.2, 0.24}, {0.0, 6.0, 0.0});
  later.linear() = later.linear() * begin.linear();
  expect_near(path.at(3.0).pose, later);
  EXPECT_EQ(BodyPath().at(7.0).pose, core::Pose{});
}

TEST(BodyPath, RefusesPosesLikeController) {
  const Eigen::Isometry3d here = Eigen::Isometry3d::Identity();
  const auto at = [](double x) { return isometry({x, 0.0, 0.0}); };
  Eigen::Isometry3d scaled = here;
  scaled.linear() *= 1.01;
  const std::vector<std::vector<Keyframe>> bad = {
      {},
      {{0.0, here}, {0.0, here}},
      {{1.0, here}, {0.0, here}},
      {{kNan, here}, {1.0, here}},
      {{0.0, here}, {1.0, at(10.1)}},
      {{0.0, here}, {1.0, at(kNan)}},
      {{0.0, scaled}},
      {{0.0, at(-6.0)}, {1.0, at(5.0)}},                        // 11 m/s
      {{0.0, here}, {0.02, isometry({0, 0, 0}, {0, 0, 2.5})}},  // 125 rad/s
  };
  for (std::size_t i = 0; i < bad.size(); ++i) {
    EXPECT_THROW(BodyPath{bad[i]}, std::invalid_argument) << i;
  }
  EXPECT_THROW(BodyPath(here, {10.1, 0.0, 0.0}, {0.0, 0.0, 0.0}), std::invalid_argument);
  EXPECT_THROW(BodyPath(here, {0.0, 0.0, 0.0}, {0.0, 0.0, 101.0}), std::invalid_argument);
  EXPECT_THROW(BodyPath(here, {0.0, kNan, 0.0}, {0.0, 0.0, 0.0}), std::invalid_argument);
  EXPECT_NO_THROW(BodyPath({{0.0, at(-4.9)}, {1.0, at(5.0)}}));
}

}  // namespace
}  // namespace tactree::test
