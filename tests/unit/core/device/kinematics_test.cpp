#include "tactree/core/device/kinematics.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace tactree::test {
namespace {

TEST(Cartesian, ConvertsCountsToMetres) {
  core::DeviceModel device;
  device.counts_per_m[0] = 1000.0F;
  device.counts_per_m[1] = 2000.0F;
  device.counts_per_m[2] = 4000.0F;
  device.home_count[1] = 500;
  ASSERT_TRUE(core::is_valid(device));
  const core::DevicePose pose = core::locate(device, {1000, 500, -4000});
  ASSERT_TRUE(pose.valid);
  EXPECT_EQ(pose.probe, (core::Vec3{1.0F, 0.0F, -1.0F}));
}

TEST(Cartesian, EquatesEffortAndForce) {
  const core::DevicePose pose = core::locate({}, {1, 2, 3});
  EXPECT_EQ((pose.effort_per_force * core::Vec3{1.0F, -2.0F, 3.0F}),
            (core::Vec3{1.0F, -2.0F, 3.0F}));
}

TEST(Cartesian, UsesDifferenceFromHome) {
  core::DeviceModel device;
  device.counts_per_m[0] = 1000.0F;
  device.home_count[0] = std::numeric_limits<std::int32_t>::max();
  const core::DevicePose pose =
      core::locate(device, {std::numeric_limits<std::int32_t>::min(), 0, 0});
  EXPECT_EQ(pose.probe.x, 0.001F);
}

TEST(Cartesian, AcceptsEveryCount) {
  core::DeviceModel device;
  device.counts_per_m[0] = 1.0F;
  for (const std::int32_t count : {std::numeric_limits<std::int32_t>::min(), -1, 0,
                                   std::numeric_limits<std::int32_t>::max()}) {
    EXPECT_TRUE(core::locate(device, {count, count, count}).valid);
  }
}

TEST(Device, RefusesUnknownKind) {
  core::DeviceModel device;
  device.kind = static_cast<core::DeviceKind>(200);
  EXPECT_FALSE(core::is_valid(device));
  EXPECT_FALSE(core::locate(device, {0, 0, 0}).valid);
}

}  // namespace
}  // namespace tactree::test
