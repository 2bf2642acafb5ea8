// The controller's kinematics against the simulated device's, over the whole workspace of every
// preset: two implementations, float32 and double, from different equations.

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>
#include <random>

#include "print_preset.hpp"
#include "tactree/core/configuration/device_presets.hpp"
#include "tactree/core/device/kinematics.hpp"
#include "tactree/core/math/sine.hpp"
#include "tactree/plant/linkage.hpp"
#include "tactree/plant/trigonometry.hpp"

namespace tactree::test {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using plant::Linkage;

constexpr double kDegrees = 57.29577951308232;

Vector3d wide(core::Vec3 v) {
  return {static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z)};
}

/// Columns: the probe's motion per motion of each joint.
Matrix3d jacobian_of(const core::DevicePose& pose) {
  Matrix3d m;
  for (Eigen::Index i = 0; i < 3; ++i) {
    m.col(i) = wide(pose.effort_per_force.row[i]);
  }
  return m;
}

/// Joints spread evenly over their ranges, as float32.
class Joints {
 public:
  explicit Joints(const core::DeviceModel& model, std::uint32_t seed)
      : model_(model), random_(seed) {}
  core::Vec3 next() {
    float q[core::kAxes] = {0.0F, 0.0F, 0.0F};
    for (std::uint32_t i = 0; i < core::axes_of(model_.kind); ++i) {
      q[i] =
          std::uniform_real_distribution<float>(model_.joint_min[i], model_.joint_max[i])(random_);
    }
    return {q[0], q[1], q[2]};
  }

 private:
  const core::DeviceModel& model_;
  std::mt19937 random_;
};

struct Errors {
  double place_m = 0.0;
  double share = 0.0;      // of a column's length
  double angle_deg = 0.0;  // of a column's direction
  int poses = 0;
};

void compare_columns(const Matrix3d& found, const Matrix3d& expected, Errors& errors) {
  const double scale = expected.colwise().norm().maxCoeff();
  for (Eigen::Index i = 0; i < 3; ++i) {
    const double size = expected.col(i).norm();
    if (size < 0.02 * scale) {
      ASSERT_LT((found.col(i) - expected.col(i)).norm(), 1e-5 * scale);
      continue;  // no direction to speak of
    }
    errors.share = std::max(errors.share, std::abs(found.col(i).norm() / size - 1.0));
    const double sine = found.col(i).cross(expected.col(i)).norm() / (found.col(i).norm() * size);
    errors.angle_deg = std::max(errors.angle_deg, kDegrees * std::asin(std::min(1.0, sine)));
  }
}

class EveryDevice : public testing::TestWithParam<core::DevicePreset> {};

TEST_P(EveryDevice, AgreesWithSimulatedLinkage) {
  const core::DeviceModel& model = GetParam().model;
  const Linkage linkage(model);
  Joints joints(model, 1);
  Errors errors;
  for (int i = 0; i < 20000; ++i) {
    const core::Vec3 q = joints.next();
    const core::DevicePose pose = core::locate_joints(model, q);
    if (!pose.valid) {
      continue;
    }
    const auto expected = linkage.pose(wide(q));
    ASSERT_TRUE(expected.has_value());
    errors.place_m = std::max(errors.place_m, (wide(pose.probe) - expected->tip_m).norm());
    compare_columns(jacobian_of(pose), expected->jacobian, errors);
    ++errors.poses;
  }
  EXPECT_GT(errors.poses, 12000);
  EXPECT_LT(errors.place_m, 0.5e-6);
  EXPECT_LT(errors.share, 1e-4);
  EXPECT_LT(errors.angle_deg, 0.01);
}

// Differences of the double-precision position: a third, independent computation of the columns.
TEST_P(EveryDevice, JacobianAgreesWithNumericDifferences) {
  const core::DeviceModel& model = GetParam().model;
  const Linkage linkage(model);
  Joints joints(model, 2);
  Errors errors;
  for (int i = 0; i < 3000; ++i) {
    const core::Vec3 q = joints.next();
    const core::DevicePose pose = core::locate_joints(model, q);
    if (!pose.valid) {
      continue;
    }
    Matrix3d expected = Matrix3d::Zero();
    bool inside = true;
    for (Eigen::Index axis = 0; axis < linkage.axes(); ++axis) {
      const double h = 1e-5;
      const auto above = linkage.pose(wide(q) + h * Vector3d::Unit(axis));
      const auto below = linkage.pose(wide(q) - h * Vector3d::Unit(axis));
      inside = inside && above && below;
      if (inside) {
        expected.col(axis) = (above->tip_m - below->tip_m) / (2.0 * h);
      }
    }
    ASSERT_TRUE(inside);
    compare_columns(jacobian_of(pose), expected, errors);
    ++errors.poses;
  }
  EXPECT_GT(errors.poses, 1800);
  EXPECT_LT(errors.share, 1e-4);
  EXPECT_LT(errors.angle_deg, 0.01);
}

TEST_P(EveryDevice, GravityEffortMatchesPotentialGradient) {
  const core::DeviceModel& model = GetParam().model;
  const Linkage linkage(model);
  Joints joints(model, 3);
  int poses = 0;
  for (int i = 0; i < 2000; ++i) {
    const core::Vec3 q = joints.next();
    const core::DevicePose pose = core::locate_joints(model, q);
    if (!pose.valid) {
      continue;
    }
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      const double h = 1e-5;
      const Vector3d step =
          axis < linkage.axes() ? Vector3d(h * Vector3d::Unit(axis)) : Vector3d::Zero();
      const double slope =
          (linkage.potential_J(wide(q) + step) - linkage.potential_J(wide(q) - step)) / (2.0 * h);
      ASSERT_NEAR(wide(pose.gravity_effort)[axis], slope, 2e-6) << axis;
    }
    ++poses;
  }
  EXPECT_GT(poses, 1200);
}

TEST_P(EveryDevice, RoundTripsWithinOneCount) {
  const core::DeviceModel& model = GetParam().model;
  Joints joints(model, 4);
  for (int i = 0; i < 2000; ++i) {
    const Vector3d q = wide(joints.next());
    std::int32_t counts[core::kAxes] = {0, 0, 0};
    for (std::uint32_t axis = 0; axis < core::axes_of(model.kind); ++axis) {
      const double home = static_cast<double>(model.home_position[axis]);
      const double per_unit = static_cast<double>(core::counts_per_unit(model, axis));
      counts[axis] = static_cast<std::int32_t>(std::floor((q[axis] - home) * per_unit));
    }
    const Vector3d back = wide(core::joints_of(model, counts));
    for (std::uint32_t axis = 0; axis < core::axes_of(model.kind); ++axis) {
      const double per_unit = static_cast<double>(core::counts_per_unit(model, axis));
      const double behind = (q[axis] - back[axis]) * per_unit;
      ASSERT_GE(behind, -0.01);
      ASSERT_LE(behind, 1.01);
    }
  }
}

TEST_P(EveryDevice, RefusesJointsOutsideTheirRanges) {
  const core::DeviceModel& model = GetParam().model;
  ASSERT_TRUE(core::is_valid(model));
  Joints joints(model, 5);
  for (int i = 0; i < 200; ++i) {
    for (std::uint32_t axis = 0; axis < core::axes_of(model.kind); ++axis) {
      const core::Vec3 q = joints.next();
      float beyond[core::kAxes] = {q.x, q.y, q.z};
      beyond[axis] = model.joint_max[axis] + 1.01F * model.joint_margin[axis];
      const core::Vec3 outside = {beyond[0], beyond[1], beyond[2]};
      ASSERT_FALSE(core::locate_joints(model, outside).valid);
      beyond[axis] = model.joint_min[axis] - 1.01F * model.joint_margin[axis];
      ASSERT_FALSE(core::locate_joints(model, {beyond[0], beyond[1], beyond[2]}).valid);
      beyond[axis] = std::nanf("");
      ASSERT_FALSE(core::locate_joints(model, {beyond[0], beyond[1], beyond[2]}).valid);
    }
  }
}

TEST_P(EveryDevice, ForceFadesTowardsRangeEnd) {
  const core::DeviceModel& model = GetParam().model;
  const Vector3d at_origin = Linkage(model).joints_near(Vector3d::Zero());
  const core::Vec3 middle = {static_cast<float>(at_origin.x()), static_cast<float>(at_origin.y()),
                             static_cast<float>(at_origin.z())};
  ASSERT_EQ(core::locate_joints(model, middle).reach, 1.0F);
  core::Vec3 end = middle;
  end.x = model.joint_max[0] - 0.25F * model.joint_margin[0];
  const core::DevicePose near_end = core::locate_joints(model, end);
  ASSERT_TRUE(near_end.valid);
  EXPECT_LE(near_end.reach, 0.26F);
  end.x = model.joint_max[0] + 0.5F * model.joint_margin[0];
  EXPECT_EQ(core::locate_joints(model, end).reach, 0.0F);
}

TEST_P(EveryDevice, ReachesOriginAndSurroundings) {
  const core::DeviceModel& model = GetParam().model;
  const Linkage linkage(model);
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    for (const double way : {-0.02, 0.0, 0.02}) {
      const Vector3d wanted = way * Vector3d::Unit(axis);
      const auto pose = linkage.pose(linkage.joints_near(wanted));
      ASSERT_TRUE(pose.has_value());
      const bool planar = model.kind == core::DeviceKind::kFiveBar && axis == 0;
      const bool line = model.kind == core::DeviceKind::kPaddle && axis != 2;
      const double free_m = planar || line                            ? 0.021
                            : model.kind == core::DeviceKind::kPaddle ? 0.004
                                                                      : 5e-5;
      EXPECT_LT((pose->tip_m - wanted).norm(), free_m) << axis << " " << way;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Presets, EveryDevice, testing::ValuesIn(core::kDevicePresets),
                         [](const auto& test) { return std::string(test.param.name); });

TEST(Sine, IsWithinItsStatedError) {
  double near = 0.0;
  double far = 0.0;
  for (int i = -1'000'000; i <= 1'000'000; ++i) {
    const float small = static_cast<float>(i * 6.2831e-6);
    const float large = static_cast<float>(i * 1e-3);
    const auto error = [](float angle) {
      const core::SineCosine found = core::sine_cosine(angle);
      const double exact = static_cast<double>(angle);
      return std::max(std::abs(static_cast<double>(found.sine) - std::sin(exact)),
                      std::abs(static_cast<double>(found.cosine) - std::cos(exact)));
    };
    near = std::max(near, error(small));
    far = std::max(far, error(large));
  }
  EXPECT_LE(near, 1.2e-7);
  EXPECT_LE(far, 2e-7);
  EXPECT_EQ(core::sine_cosine(1001.0F).cosine, 1.0F);
  EXPECT_EQ(core::sine_cosine(std::nanf("")).sine, 0.0F);
}

TEST(Sine, SimulationStaysWithinStatedError) {
  const auto expect_within = [](double error, double angle) {
    const plant::SineCosine found = plant::sine_cosine(angle);
    ASSERT_NEAR(found.sine, std::sin(angle), error) << angle;
    ASSERT_NEAR(found.cosine, std::cos(angle), error) << angle;
  };
  for (int i = -100'000; i <= 100'000; ++i) {
    expect_within(4e-16, i * 3.14159e-5);
    expect_within(1e-12, i * 1e-2);
  }
}

// The values of the table match published measurements.
TEST(Presets, HaveResolutionOfTheirClass) {
  const auto step_um = [](const core::DevicePreset& preset, std::uint32_t axis) {
    const core::DeviceModel& m = preset.model;
    const Vector3d q = Linkage(m).joints_near(Vector3d::Zero());
    const core::DevicePose pose = core::locate_joints(
        m, {static_cast<float>(q.x()), static_cast<float>(q.y()), static_cast<float>(q.z())});
    return 1e6 * static_cast<double>(core::length(pose.effort_per_force.row[axis]) /
                                     core::absolute(core::counts_per_unit(m, axis)));
  };
  EXPECT_NEAR(step_um(core::presets::premium(), 1), 28.7, 0.1);  // 0.03 mm
  EXPECT_NEAR(step_um(core::presets::hapkit(), 0), 16.5, 0.1);
  EXPECT_NEAR(step_um(core::presets::falcon(), 0), 40.0, 10.0);  // 0.06 mm
}

}  // namespace
}  // namespace tactree::test
