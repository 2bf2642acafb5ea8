// The drawn links have the lengths of the device and end at its tip, in every pose.

#include "tactree/plant/linkage_shape.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tactree/core/configuration/device_presets.hpp"
#include "tactree/plant/linkage.hpp"

namespace tactree::test {
namespace {

using Eigen::Vector3d;

constexpr double kClose_m = 1e-6;

double wide(float value) { return static_cast<double>(value); }

Vector3d random_joints(const core::DeviceModel& model, std::mt19937& random) {
  Vector3d joints = Vector3d::Zero();
  for (std::uint32_t i = 0; i < core::axes_of(model.kind); ++i) {
    std::uniform_real_distribution<double> within(wide(model.joint_min[i]),
                                                  wide(model.joint_max[i]));
    joints[i] = within(random);
  }
  return joints;
}

/// A parallelogram with pins at both ends: Stamper's closure.
void expect_closed_leg(const core::DeltaGeometry& g, const plant::Polyline& leg, std::size_t i) {
  const double place = wide(g.leg_rad[i]);
  const Vector3d aside(0.0, -std::sin(place), std::cos(place));
  const Vector3d rod = leg[2] - leg[1];
  const double side = rod.dot(aside);
  const double along = std::sqrt(rod.squaredNorm() - side * side) - wide(g.d) - wide(g.e);
  EXPECT_NEAR(std::hypot(side, along), wide(g.b), kClose_m);
  EXPECT_NEAR((leg[1] - leg[0]).norm(), wide(g.a), kClose_m);
}

void expect_lengths(const core::DeviceModel& m, const std::vector<plant::Polyline>& shape) {
  const auto link = [&](std::size_t line, std::size_t i) {
    return (shape[line][i + 1] - shape[line][i]).norm();
  };
  switch (m.kind) {
    case core::DeviceKind::kArm:
      EXPECT_NEAR(link(0, 0), wide(m.arm.arm_m), kClose_m);
      EXPECT_NEAR(link(0, 1), wide(m.arm.forearm_m), kClose_m);
      break;
    case core::DeviceKind::kDelta:
      for (std::size_t i = 0; i < 3; ++i) {
        expect_closed_leg(m.delta, shape[i], i);
      }
      break;
    case core::DeviceKind::kFiveBar:
      for (std::size_t i = 0; i < 2; ++i) {
        EXPECT_NEAR(link(i, 0), wide(m.five_bar.arm_m), kClose_m);
        EXPECT_NEAR(link(i, 1), wide(m.five_bar.forearm_m), kClose_m);
      }
      break;
    case core::DeviceKind::kPaddle:
      EXPECT_NEAR(link(0, 0), wide(m.paddle_m), kClose_m);
      break;
    case core::DeviceKind::kCartesian:
      EXPECT_EQ(shape.size(), 3U);
      break;
  }
}

TEST(LinkageShape, HasDeviceLengthsAndTip) {
  std::mt19937 random(7);
  for (const core::DevicePreset& preset : core::kDevicePresets) {
    SCOPED_TRACE(preset.name);
    const plant::Linkage linkage(preset.model);
    int drawn = 0;
    for (int i = 0; i < 200; ++i) {
      const Vector3d joints = random_joints(preset.model, random);
      const auto pose = linkage.pose(joints);
      if (!pose) {
        continue;
      }
      ++drawn;
      const auto shape = plant::linkage_shape(preset.model, joints, pose->tip_m);
      expect_lengths(preset.model, shape);
      if (preset.model.kind != core::DeviceKind::kCartesian) {
        for (const plant::Polyline& line : shape) {
          EXPECT_LT((line.back() - pose->tip_m).norm(), kClose_m);
        }
      }
    }
    EXPECT_GT(drawn, 50);
  }
}

TEST(LinkageShape, FixedJointsDoNotMove) {
  std::mt19937 random(11);
  for (const core::DevicePreset& preset : core::kDevicePresets) {
    if (preset.model.kind == core::DeviceKind::kCartesian) {
      continue;
    }
    SCOPED_TRACE(preset.name);
    const plant::Linkage linkage(preset.model);
    std::vector<plant::Polyline> first;
    for (int i = 0; i < 50; ++i) {
      const Vector3d joints = random_joints(preset.model, random);
      const auto pose = linkage.pose(joints);
      if (!pose) {
        continue;
      }
      const auto shape = plant::linkage_shape(preset.model, joints, pose->tip_m);
      first = first.empty() ? shape : first;
      for (std::size_t line = 0; line < shape.size(); ++line) {
        EXPECT_LT((shape[line].front() - first[line].front()).norm(), kClose_m);
      }
    }
  }
}

}  // namespace
}  // namespace tactree::test
