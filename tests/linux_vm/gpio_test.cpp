// Encoders, enable line and switches at GPIO lines of a real kernel, driven by a simulated chip.

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <functional>
#include <random>
#include <thread>

#include "gpio_sim.hpp"
#include "tactree/hal/linux/gpio_board.hpp"

namespace tactree::vm_test {
namespace {

using namespace hal::linux_gpio;

enum Line : std::size_t { kA0, kB0, kA1, kB1, kEnable, kReadBack, kStop, kDeadMan };
const std::vector<std::string> kNames = {"encoder0-a", "encoder0-b", "encoder1-a", "encoder1-b",
                                         "enable",     "read-back",  "e-stop",     "dead-man"};
const std::vector<EncoderLines> kAxes = {{"encoder0-a", "encoder0-b"},
                                         {"encoder1-a", "encoder1-b"}};

class Gpio : public testing::Test {
 protected:
  /// A quarter of a period of an encoder, and the board takes notice.
  void turn(std::size_t axis, int way, GpioEncoderBank& bank) {
    step(axis, position_[axis] += way);
    settle(bank, axis);
  }
  /// Only the line that changes: a call is an edge.
  void step(std::size_t axis, int position) {
    const unsigned quarter = static_cast<unsigned>(position) & 3U;
    const std::array<bool, 2> levels = {quarter == 1U || quarter == 2U, quarter >= 2U};
    for (std::size_t k = 0; k < 2; ++k) {
      if (levels_[2 * axis + k] != levels[k]) {
        levels_[2 * axis + k] = levels[k];
        chip_.pull(2 * axis + k, levels[k]);
      }
    }
  }
  /// Edges are told by an interrupt: a moment later.
  void settle(GpioEncoderBank& bank, std::size_t axis) {
    for (int i = 0; i < 10000 && bank.read().counts[axis] != position_[axis]; ++i) {
      std::this_thread::yield();
    }
  }

  GpioSim chip_{"board", kNames};
  std::array<int, 3> position_{};
  std::array<bool, 4> levels_{};
};

std::string refusal(const std::function<void()>& act) {
  try {
    act();
  } catch (const GpioError& error) {
    return error.what();
  }
  return "not refused";
}

bool holds(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST_F(Gpio, EncodersCountEveryEdgeInLockStep) {
  GpioEncoderBank bank(kAxes, "tactree", 0);
  std::mt19937 random(1);
  for (int i = 0; i < 2000; ++i) {
    const std::size_t axis = random() % 2U;
    turn(axis, random() % 3U == 0U ? -1 : 1, bank);
    const core::EncoderReading reading = bank.read();
    ASSERT_EQ(reading.counts[axis], position_[axis]) << "step " << i;
    ASSERT_TRUE(reading.valid[0] && reading.valid[1]);
  }
  EXPECT_EQ(bank.lost(), 0U);
  EXPECT_GT(bank.last_edge_ns(), 0U);
  std::printf("encoders: 2000 edges in lock-step, %u lost\n", bank.lost());
}

/// As fast as this kernel takes them, read once in a while, as a loop does.
TEST_F(Gpio, AMillionEdgesLeaveTheExactCount) {
  constexpr int kEdges = 1'000'000;
  constexpr int kEdgesPerRead = 50;
  GpioEncoderBank bank(kAxes, "tactree", 0);
  std::array<int, 2> position{};
  std::mt19937 random(2);
  for (int i = 0; i < kEdges; i += kEdgesPerRead) {
    const std::size_t axis = random() % 2U;
    const int way = random() % 2U == 0U ? -1 : 1;
    for (int k = 0; k < kEdgesPerRead; ++k) {
      step(axis, position[axis] += way);
    }
    const core::EncoderReading reading = bank.read();
    ASSERT_TRUE(reading.valid[0] && reading.valid[1]) << "after " << i << " edges";
  }
  const core::EncoderReading reading = bank.read();
  EXPECT_EQ(reading.counts[0], position[0]);
  EXPECT_EQ(reading.counts[1], position[1]);
  EXPECT_EQ(bank.lost() + bank.illegal(0) + bank.illegal(1), 0U);
  std::printf("encoders: %d edges, %d to a read, %u lost\n", kEdges, kEdgesPerRead, bank.lost());
}

TEST_F(Gpio, AnIndexPulseComesWithTheCountOfItsMoment) {
  GpioEncoderBank bank({{"encoder0-a", "encoder0-b", "read-back"}, kAxes[1]}, "tactree", 0);
  turn(0, 1, bank);
  turn(0, 1, bank);
  EXPECT_FALSE(bank.read().index[0]);
  step(0, position_[0] += 1);
  chip_.pull(kReadBack, true);
  step(0, position_[0] += 1);
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
  EXPECT_FALSE(reading.index[0]) << "it is told once";
}

/// Nobody reads for a while: the kernel's buffer runs over, and that is noticed.
TEST_F(Gpio, EdgesThatWereLostAreCountedAndMakeTheAxisInvalid) {
  GpioEncoderBank bank(kAxes, "tactree", 4);
  for (int i = 0; i < 3000; ++i) {
    chip_.pull(kA0, i % 2 == 0);
    std::this_thread::sleep_for(std::chrono::microseconds(50));
  }
  bool valid = true;
  for (int i = 0; i < 200 && valid; ++i) {
    valid = bank.read().valid[0];
    chip_.pull(kA0, i % 2 == 0);
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  EXPECT_FALSE(valid);
  EXPECT_GT(bank.lost(), 4U);
  EXPECT_FALSE(bank.read().valid[0]) << "it stays so";
}

TEST_F(Gpio, ABrokenWireOfTheEmergencyStopReadsAsPressed) {
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

TEST_F(Gpio, AnEmergencyStopThatIsPressedForAMomentIsSeen) {
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

TEST_F(Gpio, TheEnableLineIsReadBackAtTheAmplifiers) {
  GpioEnableLine line("enable", "read-back", "tactree");
  EXPECT_FALSE(chip_.level(kEnable));
  line.set(true);
  EXPECT_TRUE(chip_.level(kEnable));
  EXPECT_FALSE(line.read_back()) << "the amplifiers say otherwise";
  chip_.pull(kReadBack, true);
  EXPECT_TRUE(line.read_back());
}

TEST_F(Gpio, AProgramThatIsKilledLeavesTheEnableLineFree) {
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

TEST_F(Gpio, RefusalsNameLineCauseAndRemedy) {
  const GpioLines held = GpioLines::outputs({"enable"}, "somebody", false);
  const std::string used = refusal([] { GpioEnableLine("enable", "read-back", "tactree"); });
  EXPECT_TRUE(holds(used, "line 'enable': in use by 'somebody'")) << used;
  const std::string wrong = refusal([] { GpioEnableLine("enabel", "read-back", "tactree"); });
  EXPECT_TRUE(holds(wrong, "line 'enabel': no chip has a line of that name")) << wrong;
  const GpioSim other("other", {"far-away", "dead-man"});
  const std::string apart = refusal([] {
    GpioEncoderBank({{"encoder0-a", "far-away"}}, "tactree", 0);
  });
  EXPECT_TRUE(holds(apart, "use lines of one chip")) << apart;
  const std::string twice = refusal([] { GpioSafetyInputs("e-stop", "dead-man", "tactree"); });
  EXPECT_TRUE(holds(twice, "line 'dead-man'") && holds(twice, "have one of that name")) << twice;
  EXPECT_EQ(find_line(chip_.label() + ":dead-man").chip, "/dev/" + chip_.chip());
  EXPECT_EQ(find_line(other.label() + ":dead-man").chip, "/dev/" + other.chip());
}

TEST_F(Gpio, WhoMayNotIsTold) {
  const pid_t child = fork();
  if (child == 0) {
    const bool other = setgid(65534) == 0 && setuid(65534) == 0;
    const std::string text = refusal([] { GpioEnableLine("enable", "read-back", "tactree"); });
    _exit(other && holds(text, "permission denied") ? 0 : 1);
  }
  int status = 1;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  EXPECT_EQ(status, 0);
}

TEST_F(Gpio, GpioinfoShowsWhoHasALine) {
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
  const std::string text = refusal([] { GpioEnableLine("enable", "read-back", "tactree"); });
  EXPECT_TRUE(holds(text, "there is no GPIO chip")) << text;
}

}  // namespace
}  // namespace tactree::vm_test
