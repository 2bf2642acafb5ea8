#include "tactree/simulation/workspace.hpp"

#include <gtest/gtest.h>

#include "print_preset.hpp"

namespace tactree::simulation {
namespace {

using core::presets::cartesian;
using Eigen::Vector3d;

class LargestBox : public testing::TestWithParam<core::DevicePreset> {};

TEST_P(LargestBox, IsReachableAndMaximal) {
  const core::DeviceModel& device = GetParam().model;
  const Vector3d size(0.05, 0.03, 0.04);
  const std::optional<double> scale = largest_scale(device, size);
  if (core::axes_of(device.kind) != core::kAxes) {
    EXPECT_FALSE(scale);
    return;
  }
  ASSERT_TRUE(scale);
  EXPECT_GT(*scale * size.x(), 0.02);
  EXPECT_LT(*scale * size.x(), 2.0);
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

TEST(Workspace, HoldsAnyBoxWithoutLimits) {
  const std::optional<double> scale = largest_scale(core::DeviceModel{}, {1.0, 1.0, 1.0});
  ASSERT_TRUE(scale);
  EXPECT_GT(*scale, 1.0);
}

}  // namespace
}  // namespace tactree::simulation
