#include "tactree/simulation/placement.hpp"

#include <gtest/gtest.h>

#include <numbers>
#include <string>

namespace tactree::simulation {
namespace {

constexpr PoseRows kIdentity = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};

std::string cause_of(const PoseRows& rows) {
  const std::optional<PoseProblem> problem = problem_of(rows);
  return problem ? problem->cause : "";
}

TEST(Placement, IsItsMatrixRowByRow) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  pose.translation() = Eigen::Vector3d(0.1, -0.2, 0.3);
  const PoseRows rows = rows_of(pose);
  EXPECT_EQ(rows[3], 0.1);
  EXPECT_EQ(rows[7], -0.2);
  EXPECT_EQ(rows[15], 1.0);
  ASSERT_EQ(cause_of(rows), "");
  EXPECT_TRUE(pose_of(rows).matrix().isApprox(pose.matrix(), 1e-14));
}

TEST(Placement, RoundedRotationIsCorrected) {
  PoseRows rows = kIdentity;
  rows[0] = 1.0004;  // its row is too long by 4e-4, its square by 8e-4
  ASSERT_EQ(cause_of(rows), "");
  EXPECT_TRUE(pose_of(rows).matrix().isApprox(Eigen::Matrix4d::Identity(), 1e-3));
  EXPECT_NEAR(pose_of(rows).linear().determinant(), 1.0, 1e-14);
}

TEST(Placement, ScaleShearMirrorAndColumnsAreRefused) {
  PoseRows scaled = kIdentity;
  scaled[0] = 1.001;
  PoseRows sheared = kIdentity;
  sheared[1] = 0.01;
  PoseRows mirrored = kIdentity;
  mirrored[0] = -1.0;
  for (const PoseRows& rows : {scaled, sheared, mirrored}) {
    EXPECT_EQ(cause_of(rows), "its upper left 3x3 part is not a rotation");
  }
  PoseRows columns = kIdentity;
  columns[12] = 0.1;
  EXPECT_EQ(cause_of(columns), "its last row is not 0, 0, 0, 1");
}

TEST(Placement, SceneAndDeviceDifferByOrigin) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() =
      Eigen::AngleAxisd(0.5 * std::numbers::pi, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  pose.translation() = Eigen::Vector3d(0.125, 0.0, 0.0);
  const core::Vec3 origin = {0.0F, 0.25F, -0.5F};
  const Eigen::Isometry3d scene = in_scene(pose, origin);
  EXPECT_EQ(scene.translation(), Eigen::Vector3d(0.125, -0.25, 0.5));
  EXPECT_EQ(scene.linear(), pose.linear());
  EXPECT_EQ(in_device(scene, origin).matrix(), pose.matrix());
}

}  // namespace
}  // namespace tactree::simulation
