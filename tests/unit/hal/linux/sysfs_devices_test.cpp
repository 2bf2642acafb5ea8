// Encoders at counters and motors at converters, on folders with the layout of /sys.

#include <gtest/gtest.h>
#include <stdlib.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>

#include "message_of.hpp"
#include "open_gate.hpp"
#include "tactree/hal/linux/converter_motors.hpp"
#include "tactree/hal/linux/counter_encoders.hpp"

namespace tactree::hal::linux_gpio {
namespace {

namespace fs = std::filesystem;

class SysfsDevices : public testing::Test {
 protected:
  void SetUp() override {
    std::string name = (fs::temp_directory_path() / "tactree-sysfs-XXXXXX").string();
    ASSERT_NE(mkdtemp(name.data()), nullptr);
    root_ = name;
    fs::create_directories(root_ / "bus");
  }
  void TearDown() override { fs::remove_all(root_); }

  void write(const std::string& file, const std::string& text) const {
    fs::create_directories((root_ / file).parent_path());
    std::ofstream(root_ / file) << text << "\n";
  }
  [[nodiscard]] std::string read(const std::string& file) const {
    std::string text;
    std::getline(std::ifstream(root_ / file), text);
    return text;
  }
  /// An entry of the bus is a link into its device's folder.
  void on_bus(const std::string& device, const std::string& entry) const {
    fs::create_directories(root_ / device / entry);
    fs::create_directory_symlink(root_ / device / entry, root_ / "bus" / entry);
  }
  void add_counter(const std::string& device, const std::string& ceiling = "4294967295") const {
    const std::string entry = "counter" + std::to_string(counters_++);
    on_bus(device, entry);
    folder_ = device + "/" + entry + "/count0/";
    write(folder_ + "function", "increase");
    write(folder_ + "enable", "0");
    write(folder_ + "ceiling", ceiling);
    write(folder_ + "count", "0");
  }
  [[nodiscard]] CounterSettings counters(std::vector<CounterAxis> axes) const {
    return {(root_ / "bus").string(), std::move(axes)};
  }

  fs::path root_;
  mutable std::string folder_;  // of the newest count
  mutable int counters_ = 0;
};

bool holds(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST_F(SysfsDevices, StartsCounterForEachEdge) {
  add_counter("1000.counter");
  CounterEncoderBank bank(counters({{"1000.counter", 0}}));
  EXPECT_EQ(read(folder_ + "function"), "quadrature x4");
  EXPECT_EQ(read(folder_ + "enable"), "1");
  const core::EncoderReading reading = bank.read();
  for (std::uint32_t i = 0; i < core::kAxes; ++i) {
    EXPECT_TRUE(reading.valid[i]);
    EXPECT_EQ(reading.counts[i], 0);
  }
}

TEST_F(SysfsDevices, SetsFullRangeIfMissing) {
  add_counter("1000.counter", "0");
  const CounterEncoderBank bank(counters({{"1000.counter", 0}}));
  EXPECT_EQ(read(folder_ + "ceiling"), "4294967295");
}

TEST_F(SysfsDevices, CountsFromInitialValue) {
  add_counter("1000.counter");
  write(folder_ + "count", "700");
  CounterEncoderBank bank(counters({{"1000.counter", 0}}));
  EXPECT_EQ(bank.read().counts[0], 0);
  write(folder_ + "count", "5700");
  EXPECT_EQ(bank.read().counts[0], 5000);
  write(folder_ + "count", "650");
  EXPECT_EQ(bank.read().counts[0], -50);
  write(folder_ + "count", "4294967290");  // back over its end
  EXPECT_EQ(bank.read().counts[0], -706);
}

TEST_F(SysfsDevices, ExtendsSmallCounterRange) {
  add_counter("1000.counter");
  // A value that nobody may write, not even root: 65536.
  fs::remove(root_ / (folder_ + "ceiling"));
  fs::create_symlink("/proc/sys/kernel/ngroups_max", root_ / (folder_ + "ceiling"));
  constexpr std::int32_t kRange = 65537;
  CounterEncoderBank bank(counters({{"1000.counter", 0}}));
  std::int32_t expected = 0;
  for (const int step : {30000, 30000, 30000, -32000, -32000, -32000, 20000}) {
    expected += step;
    write(folder_ + "count", std::to_string(((expected % kRange) + kRange) % kRange));
    EXPECT_EQ(bank.read().counts[0], expected);
  }
}

TEST_F(SysfsDevices, InvalidatesRemovedCounter) {
  add_counter("1000.counter");
  add_counter("2000.counter");
  CounterEncoderBank bank(counters({{"1000.counter", 0}, {"2000.counter", 0}}));
  for (const char* const wrong : {"", "x", "-1", "4294967296"}) {
    write(folder_ + "count", "0");
    CounterEncoderBank fresh(counters({{"2000.counter", 0}}));
    EXPECT_TRUE(fresh.read().valid[0]);
    write(folder_ + "count", wrong);
    EXPECT_FALSE(fresh.read().valid[0]) << wrong;
    write(folder_ + "count", "0");
    EXPECT_FALSE(fresh.read().valid[0]) << "it stays so: where it was meanwhile nobody knows";
    EXPECT_TRUE(bank.read().valid[0]) << "the other one counts on";
  }
}

TEST_F(SysfsDevices, RefusesUnusableCounter) {
  const auto make = [this](std::vector<CounterAxis> axes) {
    return test::message_of<SysfsError>([&] { const CounterEncoderBank bank(counters(axes)); });
  };
  EXPECT_TRUE(holds(make({{"1000.counter", 0}}), "counter '1000.counter': no such device in"));
  add_counter("1000.counter");
  EXPECT_TRUE(holds(make({}), "one to three axes"));
  EXPECT_TRUE(holds(make({{"2000.counter", 0}}), "use one of: 1000.counter"));
  EXPECT_TRUE(holds(make({{"1000.counter", 1}}), "it has no count 1"));
  write(folder_ + "count", "none");
  EXPECT_TRUE(holds(make({{"1000.counter", 0}}), "count: has no valid count"));
  write(folder_ + "count", "0");
  fs::remove(root_ / (folder_ + "function"));
  fs::create_directories(root_ / (folder_ + "function"));  // takes no value
  EXPECT_TRUE(holds(make({{"1000.counter", 0}}), "does not accept 'quadrature x4'"));
}

TEST_F(SysfsDevices, RefusesCounterWithoutRange) {
  add_counter("1000.counter");
  fs::remove(root_ / (folder_ + "ceiling"));
  fs::create_directories(root_ / (folder_ + "ceiling"));
  EXPECT_FALSE(test::message_of<SysfsError>([&] {
                 const CounterEncoderBank bank(counters({{"1000.counter", 0}}));
               }).empty());
}

ConverterAxis bipolar() { return {"spi0.0", 0, 2048, 4095, 8.0F}; }

TEST(ConverterCode, IsProportionalAndClamped) {
  const ConverterAxis axis = bipolar();
  EXPECT_EQ(code_of(axis, 0.0F), 2048);
  EXPECT_EQ(code_of(axis, 8.0F), 4095);
  EXPECT_EQ(code_of(axis, -8.0F), 1);
  EXPECT_EQ(code_of(axis, 4.0F), 2048 + 1024);
  EXPECT_EQ(code_of(axis, 100.0F), 4095);
  EXPECT_EQ(code_of(axis, -100.0F), 1);
  const float infinity = std::numeric_limits<float>::infinity();
  EXPECT_EQ(code_of(axis, infinity), 4095);
  EXPECT_EQ(code_of(axis, -infinity), 1);
  EXPECT_EQ(code_of(axis, std::nanf("")), 2048);
  const ConverterAxis mirrored{"spi0.0", 0, 2048, 1, 8.0F};
  EXPECT_EQ(code_of(mirrored, 8.0F), 1);
  EXPECT_EQ(code_of(mirrored, -8.0F), 4095);
}

class Converters : public SysfsDevices {
 protected:
  void SetUp() override {
    SysfsDevices::SetUp();
    on_bus("spi0.0", "iio:device3");
    write(kFile, "17");
  }
  [[nodiscard]] ConverterSettings settings(ConverterAxis axis = bipolar()) const {
    return {(root_ / "bus").string(), {std::move(axis)}, ""};
  }
  static constexpr char kFile[] = "spi0.0/iio:device3/out_voltage0_raw";
};

TEST_F(Converters, GivesNoEffortOutsideCommands) {
  {
    ConverterMotors motors(settings(), "test");
    EXPECT_EQ(read(kFile), "2048");
    motors.write(test::command_of(-2.0F));
    EXPECT_EQ(read(kFile), "1536");
    EXPECT_TRUE(motors.healthy());
    motors.release();
    EXPECT_EQ(read(kFile), "2048");
    motors.write(test::command_of(8.0F));
    EXPECT_EQ(read(kFile), "4095");
  }
  EXPECT_EQ(read(kFile), "2048");
}

TEST_F(Converters, NamesMissingDevices) {
  ConverterAxis axis = bipolar();
  axis.device = "spi0.1";
  const auto make = [&] {
    return test::message_of<SysfsError>(
        [&] { const ConverterMotors motors(settings(axis), "test"); });
  };
  EXPECT_TRUE(holds(make(), "converter 'spi0.1': no such device in"));
  EXPECT_TRUE(holds(make(), "use one of: spi0.0"));
  axis = bipolar();
  axis.channel = 1;
  EXPECT_TRUE(holds(make(), "it has no output 1"));
}

}  // namespace
}  // namespace tactree::hal::linux_gpio
