// The headers that `tactree device to-header` writes: the build writes and compiles them.

#include <gtest/gtest.h>

#include <bit>
#include <cstdint>

#include "cartesian.hpp"
#include "device_fields.hpp"
#include "falcon.hpp"
#include "hapkit.hpp"
#include "odd.hpp"
#include "pantograph.hpp"
#include "premium.hpp"
#include "tactree/support/device_file.hpp"
#include "wooden.hpp"

namespace tactree::support {
namespace {

constexpr const char* kOddFile = TACTREE_TEST_DEVICE;

/// Compares all values, also those that the kind of the device does not use.
void expect_same(core::DevicePreset compiled, const Device& device) {
  core::DevicePreset read = device.preset;
  EXPECT_EQ(compiled.name, device.name);
  EXPECT_EQ(compiled.about, device.about);
  EXPECT_EQ(compiled.model.kind, read.model.kind);
  EXPECT_EQ(compiled.model.homing, read.model.homing);
  for (const DeviceField& field : device_fields()) {
    const DeviceValues values = field.values(compiled);
    const DeviceValues expected = field.values(read);
    for (std::size_t i = 0; i < field.count(); ++i) {
      EXPECT_EQ(std::bit_cast<std::uint32_t>(*values[i]),
                std::bit_cast<std::uint32_t>(*expected[i]))
          << device.name << " " << field.key << "[" << i << "]";
    }
  }
  for (std::size_t i = 0; i < core::kAxes; ++i) {
    EXPECT_EQ(compiled.model.home_count[i], read.model.home_count[i]);
  }
}

TEST(DeviceHeader, HasBitsOfFile) {
  const Device odd = load_device(kOddFile);
  expect_same(kOdd, odd);
  EXPECT_TRUE(core::is_valid(kOdd.model));
  // The file has what a literal may lose: many digits, the smallest and largest exponents, -0.
  EXPECT_EQ(std::bit_cast<std::uint32_t>(kOdd.model.delta.c), 0x80000000U);
  EXPECT_EQ(kOdd.model.delta.f, 1e-45F);
  EXPECT_EQ(std::string(kOdd.about), "a \"quoted\" \\ name?\?/\n with \xC3\xA4, 7");
}

TEST(DeviceHeader, HasBitsOfPresets) {
  expect_same(kCartesian, load_device("cartesian"));
  expect_same(kPremium, load_device("premium"));
  expect_same(kWooden, load_device("wooden"));
  expect_same(kFalcon, load_device("falcon"));
  expect_same(kPantograph, load_device("pantograph"));
  expect_same(kHapkit, load_device("hapkit"));
}

TEST(DeviceHeader, ConfiguresController) {
  constexpr core::Configuration kConfiguration = [] {
    core::Configuration configuration;
    core::use_device(kOdd, configuration);
    return configuration;
  }();
  EXPECT_EQ(kConfiguration.device.kind, core::DeviceKind::kDelta);
  EXPECT_EQ(kConfiguration.limits.force_max_N, kOdd.drive.force_max_N);
}

TEST(DeviceHeader, KeepsSourceInComment) {
  const std::string header = device_header(load_device("hapkit"), "kMine", "a.json\n#error \\");
  EXPECT_NE(header.find("from a.json_#error _. Change"), std::string::npos) << header;
  EXPECT_NE(header.find("DevicePreset kMine = "), std::string::npos);
}

}  // namespace
}  // namespace tactree::support
