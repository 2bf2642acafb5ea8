// Models and devices that do not fit.

#include "tactree/setup/model_size.hpp"

#include <gtest/gtest.h>

#include <string>

#include "tactree/core/configuration/device_presets.hpp"
#include "test_models.hpp"

namespace tactree::test {
namespace {

bool has(const std::optional<std::string>& text, const std::string& part) {
  return text.value_or("").find(part) != std::string::npos;
}

std::optional<std::string> warning(const TestBlob& blob, const core::DevicePreset& device) {
  return setup::oversize_warning(blob.view(), device.name, device.model);
}

std::optional<std::string> warning_at(const TestBlob& blob, const core::DevicePreset& device,
                                      const Eigen::Vector3d& place_m) {
  return setup::misplaced_warning(blob.view(), device.name, device.model,
                                  Eigen::Isometry3d(Eigen::Translation3d(place_m)));
}

/// Two balls with nothing between them.
builder::Model two_balls(double distance_m, double radius_m) {
  builder::Model both = sphere(radius_m, 0.2 * radius_m);
  const builder::Model one = both;
  for (std::size_t i = 0; i < one.positions.size(); ++i) {
    both.positions.push_back(one.positions[i] + distance_m * Eigen::Vector3d::UnitX());
    both.normals.push_back(one.normals[i]);
  }
  return both;
}

TEST(ModelSize, StatesWhatPlanarDeviceReaches) {
  const core::DevicePreset device = core::presets::pantograph();
  EXPECT_EQ(warning(TestBlob(sphere(0.015, 0.002)), device), std::nullopt);
  const auto large = warning(TestBlob(sphere(0.1, 0.005)), device);
  EXPECT_TRUE(has(large, "more than pantograph reaches in the plane of its probe")) << *large;
  EXPECT_TRUE(has(large, "(build it with --fit device:pantograph)")) << *large;
  const auto larger = warning(TestBlob(two_balls(2.0, 0.1)), device);
  EXPECT_TRUE(has(larger, "pantograph does not reach its surface in the plane of its probe"))
      << larger.value_or("");
  const auto apart = warning(TestBlob(two_balls(0.5, 0.01)), device);
  EXPECT_TRUE(has(apart, "pantograph does not reach the model in the plane of its probe"))
      << apart.value_or("");
}

TEST(ModelSize, StatesWhatPaddleReaches) {
  const core::DevicePreset device = core::presets::hapkit();
  EXPECT_EQ(warning(TestBlob(sphere(0.015, 0.002)), device), std::nullopt);
  const auto large = warning(TestBlob(sphere(0.1, 0.005)), device);
  EXPECT_TRUE(has(large, "more than hapkit reaches on the arc of its probe")) << *large;
}

TEST(ModelSize, PlanarDeviceMeetsPlacedModelOrNot) {
  const core::DevicePreset device = core::presets::pantograph();
  const TestBlob ball(sphere(0.015, 0.002));
  EXPECT_EQ(warning_at(ball, device, {0.0, 0.0, -0.016}), std::nullopt);
  EXPECT_TRUE(has(warning_at(ball, device, {0.0, 0.0, -0.05}), "does not reach all of the model"));
  for (const Eigen::Vector3d& beyond : {Eigen::Vector3d(0.1, 0.0, 0.0), Eigen::Vector3d(0, 0, 1)}) {
    EXPECT_TRUE(has(warning_at(ball, device, beyond),
                    "pantograph does not reach the model in the plane of its probe where it is"));
  }
}

TEST(ModelSize, PaddleMeetsPlacedModelOrNot) {
  const core::DevicePreset device = core::presets::hapkit();
  const TestBlob ball(sphere(0.1, 0.005));
  EXPECT_EQ(warning_at(ball, device, {0.0, 0.0, -0.1}), std::nullopt);
  EXPECT_TRUE(has(warning_at(ball, device, {0.0, 0.2, -0.1}),
                  "hapkit does not reach the model on the arc of its probe"));
}

TEST(ModelSize, FittedPlacementIsReached) {
  const TestBlob blob(sphere(0.1, 0.005));
  for (const core::DevicePreset& device :
       {core::presets::premium(), core::presets::pantograph(), core::presets::hapkit()}) {
    const auto fitted = setup::fitted_placement(device.model, blob.view().header(), {});
    ASSERT_TRUE(fitted) << device.name;
    const TestBlob scaled(sphere(0.1 * fitted->scale, 0.005 * fitted->scale));
    EXPECT_EQ(setup::misplaced_warning(scaled.view(), device.name, device.model, fitted->pose),
              std::nullopt)
        << device.name;
    EXPECT_EQ(warning(scaled, device), std::nullopt) << device.name;
  }
}

}  // namespace
}  // namespace tactree::test
