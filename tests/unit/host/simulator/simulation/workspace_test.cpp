#include "tactree/simulation/workspace.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "print_preset.hpp"
#include "tactree/plant/linkage.hpp"

namespace tactree::simulation {
namespace {

using core::presets::cartesian;
using Eigen::Vector3d;

class LargestBox : public testing::TestWithParam<core::DevicePreset> {};

TEST_P(LargestBox, IsReachableAndMaximal) {
  const core::DeviceModel& device = GetParam().model;
  const Vector3d size(0.05, 0.03, 0.04);
  const std::optional<double> scale = largest_scale(device, size);
  ASSERT_TRUE(scale);
  EXPECT_GT(*scale * size.x(), 0.02);
  EXPECT_LT(*scale * size.x(), 2.0);
  EXPECT_TRUE(reaches_box(device, *scale * size));
  EXPECT_FALSE(reaches_box(device, 1.01 * *scale * size));
  if (core::axes_of(device.kind) != core::kAxes) {
    return;  // a section of the box, below the origin
  }
  bool all = true;
  bool all_of_larger = true;
  for (unsigned corner = 0; corner < 8U; ++corner) {
    const Vector3d sign(corner & 1U ? 1 : -1, corner & 2U ? 1 : -1, corner & 4U ? 1 : -1);
    all &= reaches(device, 0.5 * *scale * size.cwiseProduct(sign));
    all_of_larger &= reaches(device, 0.55 * *scale * size.cwiseProduct(sign));
  }
  EXPECT_TRUE(all);
  EXPECT_FALSE(all_of_larger);
}

INSTANTIATE_TEST_SUITE_P(Workspace, LargestBox, testing::ValuesIn(core::kDevicePresets));

TEST(Workspace, SubtractsMarginsFromLinearRange) {
  const core::DeviceModel device = cartesian().model;  // half a metre to either side, 1 cm margins
  EXPECT_TRUE(reaches(device, {0.489, -0.489, 0.489}));
  EXPECT_FALSE(reaches(device, {0.495, 0.0, 0.0}));
  const std::optional<double> scale = largest_scale(device, {1.0, 0.5, 0.1});
  ASSERT_TRUE(scale);
  EXPECT_NEAR(*scale, 0.98, 2e-3);
}

TEST(Workspace, HoldsFlatNotEmptyBox) {
  EXPECT_TRUE(largest_scale(cartesian().model, {0.1, 0.1, 0.0}));
  EXPECT_FALSE(largest_scale(cartesian().model, {0.0, 0.0, 0.0}));
  EXPECT_TRUE(reaches_box(cartesian().model, {0.9, 0.9, 0.0}));
  EXPECT_FALSE(reaches_box(cartesian().model, {0.9, 1.1, 0.0}));
}

TEST(Workspace, HoldsBoxWhereItIsPlaced) {
  const core::DeviceModel device = cartesian().model;  // 0.49 m to either side
  const Vector3d size(0.9, 0.1, 0.1);
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  EXPECT_TRUE(reaches_box(device, pose, size));
  pose.translation().x() = 0.03;
  EXPECT_TRUE(reaches_box(device, pose, size));
  pose.translation().x() = 0.05;
  EXPECT_FALSE(reaches_box(device, pose, size));
  pose.linear() = Eigen::AngleAxisd(0.5 * std::numbers::pi, Vector3d::UnitZ()).toRotationMatrix();
  EXPECT_TRUE(reaches_box(device, pose, size));
  pose.translation().y() = -0.05;
  EXPECT_FALSE(reaches_box(device, pose, size));
}

TEST(Workspace, BoxHangsFromOriginOfPlanarDevice) {
  const core::DeviceModel device = core::presets::pantograph().model;
  const Vector3d section = *largest_scale(device, {1e3, 1.0, 1.0}) * Vector3d(0.0, 1.0, 1.0);
  for (const double side : {-0.5, 0.5}) {
    EXPECT_TRUE(reaches(device, {0.0, side * section.y(), 0.0}));
    EXPECT_TRUE(reaches(device, {0.0, side * section.y(), -section.z()}));
    EXPECT_FALSE(reaches(device, {0.0, 0.55 * side * section.y() / 0.5, -1.1 * section.z()}));
  }
}

TEST(Workspace, PaddleReachesHeights) {
  const core::DeviceModel device = core::presets::hapkit().model;  // 0.6 rad to either side
  const double lowest_m = 0.07 * std::sin(0.6);
  EXPECT_TRUE(reaches_box(device, {9.0, 9.0, 0.99 * lowest_m}));
  EXPECT_FALSE(reaches_box(device, {0.0, 0.0, 1.01 * lowest_m}));
  EXPECT_FALSE(reaches_box(device, {0.0, 0.0, 1.0}));
}

TEST(Workspace, StartMayBeBesideArc) {
  const core::DeviceModel device = core::presets::hapkit().model;
  EXPECT_FALSE(reaches(device, {0.0, 0.0, 0.01}));
  EXPECT_TRUE(reaches_start(device, {0.0, 0.0, 0.01}));
  EXPECT_FALSE(reaches_start(device, {0.0, -0.02, 0.01}));
  EXPECT_FALSE(reaches_start(device, {0.0, 0.0, 0.05}));
  EXPECT_FALSE(reaches_start(cartesian().model, {0.495, 0.0, 0.0}));
}

TEST(Workspace, ShapeIsBorderOfReach) {
  const core::DeviceModel device = cartesian().model;
  const ReachShape shape = reach_shape(device);
  ASSERT_EQ(shape.points_m.size(), static_cast<std::size_t>(shape.rows * shape.columns));
  for (const Vector3d& point : shape.points_m) {
    ASSERT_TRUE(reaches(device, point)) << point.transpose();
    ASSERT_NEAR(point.cwiseAbs().maxCoeff(), 0.49, 2e-3) << point.transpose();
  }
  EXPECT_NEAR(shape.points_m.front().z(), -0.49, 2e-3);
  EXPECT_NEAR(shape.points_m.back().z(), 0.49, 2e-3);
}

TEST(Workspace, ShapeOfPantographIsBorderOfItsArea) {
  const core::DeviceModel device = core::presets::pantograph().model;
  const ReachShape shape = reach_shape(device);
  ASSERT_EQ(shape.rows, 2);
  ASSERT_EQ(shape.points_m.size(), static_cast<std::size_t>(2 * shape.columns));
  const Vector3d middle = shape.points_m.front();
  EXPECT_TRUE(reaches(device, middle));
  for (int column = 0; column < shape.columns; ++column) {
    const Vector3d& border = shape.points_m[static_cast<std::size_t>(shape.columns + column)];
    const Vector3d out = (border - middle).normalized();
    EXPECT_EQ(shape.points_m[static_cast<std::size_t>(column)], middle);
    EXPECT_EQ(border.x(), middle.x());
    EXPECT_TRUE(reaches(device, border)) << border.transpose();
    EXPECT_FALSE(reaches(device, border + 2e-3 * out)) << border.transpose();
  }
}

TEST(Workspace, ShapeOfPaddleIsItsWayThereAndBack) {
  const core::DeviceModel device = core::presets::hapkit().model;
  const ReachShape shape = reach_shape(device);
  ASSERT_EQ(shape.rows, 1);
  ASSERT_EQ(shape.points_m.size(), static_cast<std::size_t>(shape.columns));
  const plant::Linkage linkage(device);
  const auto end = [&](float joint) {
    return linkage.pose({static_cast<double>(joint), 0.0, 0.0})->tip_m;
  };
  const std::size_t half = shape.points_m.size() / 2;
  EXPECT_EQ(shape.points_m[0], end(device.joint_min[0]));
  EXPECT_EQ(shape.points_m[half], end(device.joint_max[0]));
  for (std::size_t i = 1; i < half; ++i) {
    EXPECT_LT((shape.points_m[i] - shape.points_m[2 * half - i]).norm(), 1e-12);
    EXPECT_TRUE(reaches(device, shape.points_m[i]));
  }
}

TEST(Workspace, ShapeIsEmptyIfOriginIsNotReached) {
  core::DeviceModel device = cartesian().model;
  device.joint_min[2] = 0.01F;
  EXPECT_TRUE(reach_shape(device).points_m.empty());
}

TEST(Workspace, HoldsAnyBoxWithoutLimits) {
  const std::optional<double> scale = largest_scale(core::DeviceModel{}, {1.0, 1.0, 1.0});
  ASSERT_TRUE(scale);
  EXPECT_GT(*scale, 1.0);
}

}  // namespace
}  // namespace tactree::simulation
