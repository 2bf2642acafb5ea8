// Encoders, enable line and switches at GPIO lines of a real kernel, driven by a simulated chip.

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <thread>

#include "encoder_wires.hpp"
#include "message_of.hpp"

namespace tactree::vm_test {
namespace {

using namespace hal::linux_gpio;
using test::message_of;

using Gpio = EncoderWires;

bool holds(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST_F(Gpio, IndexPulseLatchesCount) {
  GpioEncoderBank bank({{"encoder0-a", "encoder0-b", "read-back"}, kAxes[1]}, "tactree", 0);
  turn(0, 1, bank);
  turn(0, 1, bank);
  EXPECT_FALSE(bank.read().index[0]);
  step(0, 1);
  chip_.pull(kReadBack, true);
  step(0, 1);
  chip_.pull(kReadBack, false);
  core::EncoderReading reading;
  for (int i = 0; i < 10000 && !reading.index[0]; ++i) {
    std::this_thread::yield();
    reading = bank.read();
  }
  EXPECT_TRUE(reading.index[0]);
  EXPECT_EQ(reading.index_count[0], 3);
  EXPECT_FALSE(reading.index[1]);
  settle(bank, 0);
  reading = bank.read();
  EXPECT_EQ(reading.counts[0], 4);
  EXPECT_FALSE(reading.index[0]) << "it is reported once";
}

TEST_F(Gpio, BrokenStopWireReadsPressed) {
  GpioSafetyInputs inputs("e-stop", "dead-man", "tactree");
  EXPECT_TRUE(inputs.emergency_stop()) << "nothing pulls the line up";
  chip_.pull(kStop, true);
  (void)inputs.emergency_stop();
  EXPECT_FALSE(inputs.emergency_stop());
  chip_.pull(kStop, false);
  EXPECT_TRUE(inputs.emergency_stop());
  EXPECT_FALSE(inputs.dead_man());
  chip_.pull(kDeadMan, true);
  EXPECT_TRUE(inputs.dead_man());
}

TEST_F(Gpio, DetectsBriefEmergencyStop) {
  GpioSafetyInputs inputs("e-stop", "dead-man", "tactree");
  chip_.pull(kStop, true);
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  (void)inputs.emergency_stop();
  EXPECT_FALSE(inputs.emergency_stop());
  chip_.pull(kStop, false);
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  chip_.pull(kStop, true);
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  EXPECT_TRUE(inputs.emergency_stop());
  EXPECT_FALSE(inputs.emergency_stop());
}

TEST_F(Gpio, ReadsEnableLineAtAmplifiers) {
  GpioEnableLine line("enable", "read-back", "tactree");
  EXPECT_FALSE(chip_.level(kEnable));
  line.set(true);
  EXPECT_TRUE(chip_.level(kEnable));
  EXPECT_FALSE(line.read_back()) << "the amplifiers say otherwise";
  chip_.pull(kReadBack, true);
  EXPECT_TRUE(line.read_back());
}

TEST_F(Gpio, KilledProgramReleasesEnableLine) {
  const pid_t child = fork();
  if (child == 0) {
    GpioEnableLine line("enable", "read-back", "tactree");
    line.set(true);
    pause();
    _exit(0);
  }
  for (int i = 0; i < 60000 && !chip_.level(kEnable); ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  ASSERT_TRUE(chip_.level(kEnable));
  ASSERT_EQ(kill(child, SIGKILL), 0);
  ASSERT_EQ(waitpid(child, nullptr, 0), child);
  // The kernel has let go of the line: the next one takes it, and it is off.
  const GpioEnableLine next("enable", "read-back", "tactree");
  EXPECT_FALSE(chip_.level(kEnable));
}

TEST_F(Gpio, RefusalsNameLineAndRemedy) {
  const GpioLines held = GpioLines::outputs({"enable"}, "somebody", false);
  const std::string used =
      message_of<GpioError>([] { GpioEnableLine("enable", "read-back", "tactree"); });
  EXPECT_TRUE(holds(used, "line 'enable': in use by 'somebody'")) << used;
  const std::string wrong =
      message_of<GpioError>([] { GpioEnableLine("enabel", "read-back", "tactree"); });
  EXPECT_TRUE(holds(wrong, "line 'enabel': no chip has a line of that name")) << wrong;
  const GpioSim other("other", {"far-away", "dead-man"});
  const std::string apart = message_of<GpioError>([] {
    GpioEncoderBank({{"encoder0-a", "far-away"}}, "tactree", 0);
  });
  EXPECT_TRUE(holds(apart, "use lines of one chip")) << apart;
  const std::string twice =
      message_of<GpioError>([] { GpioSafetyInputs("e-stop", "dead-man", "tactree"); });
  EXPECT_TRUE(holds(twice, "line 'dead-man'") && holds(twice, "have a line of that name")) << twice;
  EXPECT_EQ(find_line(chip_.label() + ":dead-man").chip, "/dev/" + chip_.chip());
  EXPECT_EQ(find_line(other.label() + ":dead-man").chip, "/dev/" + other.chip());
}

TEST_F(Gpio, NamesMissingPermission) {
  const pid_t child = fork();
  if (child == 0) {
    const bool other = setgid(65534) == 0 && setuid(65534) == 0;
    const std::string text =
        message_of<GpioError>([] { GpioEnableLine("enable", "read-back", "tactree"); });
    _exit(other && holds(text, "permission denied") ? 0 : 1);
  }
  int status = 1;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  EXPECT_EQ(status, 0);
}

TEST_F(Gpio, GpioinfoShowsLineConsumer) {
  const GpioEncoderBank bank(kAxes, "tactree encoders", 0);
  FILE* const out = popen(("gpioinfo " + chip_.chip()).c_str(), "r");
  ASSERT_NE(out, nullptr);
  std::string text;
  std::array<char, 256> piece{};
  while (std::fgets(piece.data(), static_cast<int>(piece.size()), out) != nullptr) {
    text += piece.data();
  }
  pclose(out);
  EXPECT_TRUE(holds(text, "tactree encoders")) << text;
}

TEST(GpioNoChip, IsNamed) {
  const std::string text =
      message_of<GpioError>([] { GpioEnableLine("enable", "read-back", "tactree"); });
  EXPECT_TRUE(holds(text, "there is no GPIO chip")) << text;
}

}  // namespace
}  // namespace tactree::vm_test
