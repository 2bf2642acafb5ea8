// Encoders at GPIO lines: no edge is lost in silence, however fast they come.
//
// usage: linux_gpio_test [--long]            (as root, in the test kernel)
//          --long     a million edges, a thousand ramps
//        linux_gpio_test --rates             prints the edge rates that are counted exactly; in
//        virtual time

#include <sched.h>
#include <sys/prctl.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <memory>
#include <random>
#include <stop_token>

#include "encoder_wires.hpp"

namespace tactree::vm_test {
namespace {

using namespace std::chrono_literals;

bool is_long = false;  // NOLINT: set by main()

/// Edges that libgpiod 1.6 queues for a line, and libgpiod 2.x for all lines.
constexpr int kSmallestQueue = 16;
constexpr int kMaxQueue = 1024;
/// The kernel's interrupt threads have 50.
constexpr int kAboveInterrupts = 90;

void set_priority(int priority) {
  sched_param parameters{};
  parameters.sched_priority = priority;
  ASSERT_EQ(sched_setscheduler(0, priority == 0 ? SCHED_OTHER : SCHED_FIFO, &parameters), 0);
}

class Edges : public EncoderWires {
 protected:
  /// A random walk that keeps its direction for a while.
  void turn_at_random(int edges) {
    for (int i = 0; i < edges; ++i) {
      if (random_() % 8U == 0U) {
        axis_ = random_() % 2U;
        direction_ = random_() % 2U == 0U ? -1 : 1;
      }
      step(axis_, direction_);
    }
  }
  /// After all edges have arrived, or a loss has been detected.
  static core::EncoderReading read_at_rest(GpioEncoderBank& bank) {
    (void)bank.read();
    std::this_thread::sleep_for(3ms);
    (void)bank.read();
    std::this_thread::sleep_for(3ms);
    return bank.read();
  }
  /// Null if the lines are not at rest for 2 ms within a second.
  static std::unique_ptr<GpioEncoderBank> start_at_rest() {
    try {
      return std::make_unique<GpioEncoderBank>(kAxes, "tactree", 0);
    } catch (const GpioError& error) {
      EXPECT_NE(std::string(error.what()).find("rest"), std::string::npos) << error.what();
      return nullptr;
    }
  }
  static bool is_valid(const core::EncoderReading& reading) {
    return reading.valid[0] && reading.valid[1];
  }
  bool is_exact(const core::EncoderReading& reading) const {
    return reading.counts[0] == position_[0] && reading.counts[1] == position_[1];
  }
  /// Bursts that grow until edges are lost; returns the size of the last that was counted.
  int ramp(GpioEncoderBank& bank);

  std::mt19937 random_{1};
  std::size_t axis_ = 0;
  int direction_ = 1;
};

TEST_F(Edges, AreCountedInLockStep) {
  GpioEncoderBank bank(kAxes, "tactree", 0);
  for (int i = 0; i < 2000; ++i) {
    const std::size_t axis = random_() % 2U;
    turn(axis, random_() % 3U == 0U ? -1 : 1, bank);
    const core::EncoderReading reading = bank.read();
    ASSERT_EQ(reading.counts[axis], position_[axis]) << "step " << i;
    ASSERT_TRUE(is_valid(reading));
  }
  EXPECT_EQ(bank.lost(), 0U);
}

/// As fast as this kernel takes them, read once in a while, as a loop does.
TEST_F(Edges, ManyLeaveExactCount) {
  const int edges = is_long ? 1'000'000 : 50'000;
  constexpr int kEdgesPerRead = kSmallestQueue - 1;  // a reversal toggles one line only
  GpioEncoderBank bank(kAxes, "tactree", 0);
  for (int i = 0; i < edges; i += kEdgesPerRead) {
    turn_at_random(kEdgesPerRead);
    ASSERT_TRUE(is_valid(bank.read())) << "after " << i << " edges";
  }
  const core::EncoderReading reading = read_at_rest(bank);
  EXPECT_TRUE(is_exact(reading) && is_valid(reading));
  EXPECT_EQ(bank.lost() + bank.illegal(0) + bank.illegal(1), 0U);
  std::printf("%s: %d edges, %d to a read, %u lost\n", gpio_library().c_str(), edges, kEdgesPerRead,
              bank.lost());
}

/// A loop in step with the device: at each read an edge is on its way into the queue, since its
/// thread has not run, of either axis in turn.
TEST_F(Edges, AreCountedWhileInFlight) {
  GpioEncoderBank bank(kAxes, "tactree", 0);
  set_priority(kAboveInterrupts);
  for (int i = 0; i < 200; ++i) {
    step(static_cast<std::size_t>(i) % 2U, 1);
    ASSERT_TRUE(is_valid(bank.read())) << "at read " << i;
    std::this_thread::sleep_for(1ms);
  }
  set_priority(0);
  const core::EncoderReading reading = read_at_rest(bank);
  EXPECT_TRUE(is_exact(reading) && is_valid(reading));
  EXPECT_EQ(bank.lost(), 0U);
}

// The start waits for a rest of 2 ms: a device that moves slowly has them. Its edges also come
// between the end of the rest and the first read, and then have not reached the queue. On a busy
// host the emulated computer may find no rest: such a start is refused, and is no error.
TEST_F(Edges, AreCountedDuringSlowStart) {
  const std::jthread device([&](const std::stop_token& end) {
    set_priority(kAboveInterrupts + 1);
    while (!end.stop_requested()) {
      step(0, 1);
      std::this_thread::sleep_for(std::chrono::microseconds(2000 + random_() % 500U));
    }
  });
  int counted = 0;
  for (int i = 0; i < 200 && counted < 100 && !HasFailure(); ++i) {
    set_priority(kAboveInterrupts);
    const std::unique_ptr<GpioEncoderBank> bank = start_at_rest();
    set_priority(0);
    counted += bank ? 1 : 0;
    EXPECT_TRUE(!bank || is_valid(read_at_rest(*bank)))
        << "start " << i << ": " << bank->lost() << " lost, " << bank->illegal(0) << " illegal";
  }
  EXPECT_GT(counted, 0);
}

int Edges::ramp(GpioEncoderBank& bank) {
  const bool starves = random_() % 3U == 0U;
  int counted = 0;
  for (int burst = 1 + static_cast<int>(random_() % 8U); burst < 4 * kMaxQueue;
       burst += 1 + burst / 2 + static_cast<int>(random_() % 4U)) {
    // In some bursts the threads of the interrupts do not run, and the kernel merges edges.
    const bool starve = starves && random_() % 4U == 0U;
    if (starve) {
      set_priority(kAboveInterrupts);
    }
    const int piece = 1 + static_cast<int>(random_() % static_cast<unsigned>(burst));
    for (int left = burst; left > 0; left -= piece) {
      turn_at_random(std::min(piece, left));
      if (!starve && random_() % 4U == 0U) {
        std::this_thread::sleep_for(std::chrono::microseconds(random_() % 300U));
      }
    }
    set_priority(0);
    const core::EncoderReading reading = read_at_rest(bank);
    if (!is_valid(reading)) {
      return counted;
    }
    EXPECT_TRUE(is_exact(reading)) << "wrong and valid after a burst of " << burst
                                   << (starve ? " without interrupt threads" : "");
    counted = burst;
  }
  return counted;
}

TEST_F(Edges, AreExactUnlessAxisInvalid) {
  const unsigned runs = is_long ? 1000 : 25;
  int least = 4 * kMaxQueue;
  int most = 0;
  for (unsigned run = 0; run < runs && !HasFailure(); ++run) {
    random_.seed(run);
    position_.fill(0);
    levels_.fill(false);
    for (const std::size_t line : {kA0, kB0, kA1, kB1}) {
      chip_.pull(line, false);
    }
    GpioEncoderBank bank(kAxes, "tactree", 0);
    const int counted = ramp(bank);
    EXPECT_FALSE(is_valid(bank.read())) << "run " << run << ": no edge was ever lost";
    EXPECT_GT(bank.lost() + bank.illegal(0) + bank.illegal(1), 0U);
    least = std::min(least, counted);
    most = std::max(most, counted);
  }
  std::printf("%s: %u ramps; longest burst counted before a loss: %d to %d edges\n",
              gpio_library().c_str(), runs, least, most);
}

/// Without reads the kernel's queue overflows.
TEST_F(Edges, LostInOverflowExceedTolerance) {
  GpioEncoderBank bank(kAxes, "tactree", 4);
  for (int i = 0; i < 3 * kMaxQueue; ++i) {
    chip_.pull(kA0, i % 2 == 0);
  }
  EXPECT_FALSE(read_at_rest(bank).valid[0]);
  EXPECT_GT(bank.lost(), 2U * kMaxQueue - 10U);
  EXPECT_FALSE(bank.read().valid[0]) << "it stays so";
}

/// A whole period of both lines while no thread of an interrupt runs: the levels are the same after
/// it.
TEST_F(Edges, MergedByKernelInvalidateAxis) {
  GpioEncoderBank bank(kAxes, "tactree", 0);
  set_priority(kAboveInterrupts);
  for (int i = 0; i < 6; ++i) {
    step(0, 1);
  }
  set_priority(0);
  const core::EncoderReading reading = read_at_rest(bank);
  EXPECT_FALSE(reading.valid[0]);
}

/// Edges per second that a loop of 1 kHz counts exactly for 200 of its ticks.
class Rates : public EncoderWires {
 public:
  void TestBody() override {
    double counted_hz = 0.0;
    for (double rate_hz = 5000.0; rate_hz < 1e6 && is_counted(rate_hz); rate_hz *= 1.15) {
      counted_hz = rate_hz;
    }
    std::printf("rate %s | %.0f\n", gpio_library().c_str(), counted_hz);
  }

 private:
  bool is_counted(double rate_hz);
};

bool Rates::is_counted(double rate_hz) {
  using Clock = std::chrono::steady_clock;
  constexpr auto kTick = 1ms;
  constexpr int kTicks = 200;
  GpioEncoderBank bank({kAxes[0]}, "tactree", 0);
  const int begin = position_[0];
  const auto start = Clock::now() + kTick;
  std::atomic<bool> done{false};
  std::thread motion([&] {
    (void)prctl(PR_SET_TIMERSLACK, 1);
    for (int i = 1; !done; ++i) {
      std::this_thread::sleep_until(
          start + std::chrono::nanoseconds(static_cast<std::int64_t>(1e9 * i / rate_hz)));
      step(0, 1);
    }
  });
  set_priority(80);
  bool valid = true;
  for (int i = 1; i <= kTicks && valid; ++i) {
    std::this_thread::sleep_until(start + i * kTick);
    valid = bank.read().valid[0];
  }
  done = true;
  set_priority(0);
  motion.join();
  const double reached = position_[0] - begin;
  std::this_thread::sleep_for(3ms);
  (void)bank.read();
  std::this_thread::sleep_for(3ms);
  const core::EncoderReading reading = bank.read();
  EXPECT_TRUE(!reading.valid[0] || reading.counts[0] == position_[0] - begin);
  return reading.valid[0] && reached > 0.95 * rate_hz * kTicks * 1e-3;
}

}  // namespace
}  // namespace tactree::vm_test

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  const std::string option = argc > 1 ? argv[1] : "";
  if (option == "--rates") {
    testing::RegisterTest("Rates", "Rates", nullptr, nullptr, __FILE__, __LINE__,
                          [] { return new tactree::vm_test::Rates; });
    testing::GTEST_FLAG(filter) = "Rates.*";
  } else if (option == "--long") {
    tactree::vm_test::is_long = true;
  } else if (!option.empty()) {
    std::fprintf(stderr, "usage: linux_gpio_test [--long | --rates]\n");
    return 2;
  }
  return RUN_ALL_TESTS();
}
