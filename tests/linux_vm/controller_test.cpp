// tactree-controller at GPIO lines and PWM channels: control, faults, mistakes.
//
// usage: linux_controller_test TACTREE_CONTROLLER BUNNY_BLOB
//        (as root, in the test kernel, virtual time)

#include <sys/mman.h>

#include <algorithm>
#include <cstdio>
#include <random>

#include "controller_rig.hpp"
#include "tactree/hal/linux/gpio_lines.hpp"

namespace tactree::vm_test {
namespace {

TEST_F(Controller, HomesArmsRendersAndStops) {
  serve();
  ASSERT_FALSE(HasFatalFailure());
  EXPECT_EQ(watchdog("state"), "active");
  home();
  ASSERT_FALSE(HasFatalFailure());
  arm();
  ASSERT_FALSE(HasFatalFailure());
  EXPECT_TRUE(is_enabled());
  press();
  ASSERT_FALSE(HasFatalFailure());
  std::this_thread::sleep_for(300ms);
  // Wall and hand are springs in series: the wall's share of the 5 mm is what is measured.
  const double depth = kRadius_m - hands().tip_m[2];
  const double force = hands().effort_N[2];
  EXPECT_GT(depth, 0.0005);
  EXPECT_LT(depth, 0.0030);
  expect_balance(kRadius_m - 0.005);
  EXPECT_LT(std::abs(hands().effort_N[0]), 0.3);
  const core::wire::StateReply state = board_->state();
  EXPECT_EQ(state.state, kActive);
  EXPECT_EQ(state.faults, 0U);
  EXPECT_NEAR(static_cast<double>(state.probe_m[2]), hands().tip_m[2], 0.0005);
  EXPECT_GT(hands().beats, 100U);
  kill(child_, SIGUSR1);
  ASSERT_TRUE(eventually([&] { return holds(output(), "lateness of a tick"); }));
  EXPECT_TRUE(holds(output(), "below "));
  EXPECT_EQ(watchdog("state"), "active");
  kill(child_, SIGTERM);
  EXPECT_EQ(finish(std::exchange(child_, -1)), 0) << output();
  EXPECT_FALSE(is_enabled());
  EXPECT_EQ(pwm_.width(2), 0);
  EXPECT_EQ(watchdog("state"), "inactive");
  EXPECT_FALSE(fs::exists(socket_));
  const std::string report = output();
  expect_undisturbed();
  EXPECT_TRUE(holds(report, "encoder edges lost: 0\n")) << report;
  std::printf("force %.2f N at %.2f mm; %lu edges\n%s", force, 1e3 * depth,
              static_cast<unsigned long>(hands().edges), report.c_str());
}

/// Moves down to the first contact, 3 mm further, and along the surface.
TEST_F(Controller, RendersBunny) {
  file_["model"] = bunny;
  above_m_ = 0.1;
  activate();
  ASSERT_FALSE(HasFatalFailure());
  const auto push_N = [&] {
    return std::hypot(hands().effort_N[0], hands().effort_N[1], hands().effort_N[2]);
  };
  double z_m = above_m_;
  while (push_N() < 0.3 && z_m > -above_m_) {
    z_m -= 0.001;
    device_->move_hand({0.0, 0.0, z_m}, 0.05);
  }
  ASSERT_GT(z_m, -above_m_) << "no contact";
  z_m -= 0.003;
  device_->move_hand({0.0, 0.0, z_m}, 0.05);
  std::this_thread::sleep_for(300ms);
  EXPECT_GT(push_N(), 0.8);
  expect_balance(z_m);
  for (const double x_m : {0.004, -0.004, 0.0}) {
    device_->move_hand({x_m, 0.0, z_m}, 0.05);
    EXPECT_GT(push_N(), 0.2) << "the surface ends at x = " << x_m;
  }
  EXPECT_EQ(board_->state().state, kActive);
  std::printf("the bunny: %.2f N with the hand at z = %.1f mm, %lu edges\n%s", push_N(), 1e3 * z_m,
              static_cast<unsigned long>(hands().edges), report().c_str());
  EXPECT_TRUE(holds(output(), "encoder edges lost: 0\n")) << output();
}

/// More edges than the kernel queues between two reads: the loop is suspended meanwhile, for less
/// time than its guard allows.
TEST_F(Controller, FaultsOnEdgeQueueOverflow) {
  EXPECT_EQ(run({"--version"}), 0);
  const int fits = holds(output(), "libgpiod 1.") ? 6 : 200;
  file_["real_time"]["guard_ms"] = 1000;
  activate();
  ASSERT_FALSE(HasFatalFailure());
  hands().flips = fits;
  std::this_thread::sleep_for(100ms);
  EXPECT_EQ(board_->state().state, kActive) << fits << " pulses fit into the queue";
  kill(child_, SIGSTOP);
  hands().flips = 4000;
  EXPECT_TRUE(eventually([&] { return hands().flips == 0; }));
  std::this_thread::sleep_for(200ms);
  kill(child_, SIGCONT);
  ASSERT_TRUE(eventually([&] { return !is_enabled(); })) << report();
  const auto is_invalid = [&] {
    return core::has_fault(board_->state().faults, core::Fault::kEncoderInvalid);
  };
  EXPECT_TRUE(eventually(is_invalid)) << client::names_of(board_->state().faults);
  const std::string text = report();
  EXPECT_TRUE(holds(text, "encoder edges lost: ") && !holds(text, "encoder edges lost: 0\n"))
      << text;
  board_->clear_faults();
  std::this_thread::sleep_for(50ms);
  EXPECT_TRUE(is_invalid()) << "the position stays unknown until a restart";
}

TEST_F(Controller, EmergencyStopDisablesPowerPromptly) {
  serve();
  ASSERT_FALSE(HasFatalFailure());
  home();
  ASSERT_FALSE(HasFatalFailure());
  std::mt19937 random(3);
  std::int64_t longest = 0;
  for (int i = 0; i < 20; ++i) {
    arm();
    press();
    ASSERT_FALSE(HasFatalFailure()) << "round " << i;
    std::this_thread::sleep_for(std::chrono::microseconds(random() % 50000U));
    hands().stop_to_off_ns = -1;
    hands().pull_stop = true;
    ASSERT_TRUE(eventually([&] { return hands().stop_to_off_ns >= 0; }));
    longest = std::max<std::int64_t>(longest, hands().stop_to_off_ns);
    EXPECT_LE(static_cast<double>(hands().stop_to_off_ns), 2.0 * kPeriod_ns) << "round " << i;
    EXPECT_TRUE(core::has_fault(board_->state().faults, core::Fault::kEmergencyStop));
    hands().dead_man = false;
    hands().release_stop = true;
    device_->move_hand({0.0, 0.0, 0.05}, 0.2);
    std::this_thread::sleep_for(20ms);
    EXPECT_FALSE(is_enabled()) << "stays off after the release";
    board_->clear_faults();
  }
  std::printf("emergency stop: 20 times, power off after at most %.3f ms\n",
              1e-6 * static_cast<double>(longest));
}

TEST_F(Controller, DropsEnableLineWhenKilled) {
  hold();
  ASSERT_FALSE(HasFatalFailure());
  kill(child_, SIGKILL);
  EXPECT_EQ(finish(std::exchange(child_, -1)), 1000 + SIGKILL);
  ASSERT_TRUE(eventually([&] {
    return holds(output(), "the control loop has ended; enable line off");
  })) << output();
  EXPECT_FALSE(is_enabled());
  EXPECT_EQ(watchdog("state"), "active") << "the watchdog keeps running";
  std::this_thread::sleep_for(50ms);
  hands().effort_max_N = 0.0;
  std::this_thread::sleep_for(50ms);
  EXPECT_EQ(hands().effort_max_N, 0.0);
  EXPECT_EQ(run({"--off"}), 0) << output();
  EXPECT_TRUE(holds(output(), "line 'enable' is off"));
  EXPECT_FALSE(is_enabled());
}

/// The kernel does not release the lines of a hanging program; the guard does.
TEST_F(Controller, GuardEndsHangingLoop) {
  hold();
  ASSERT_FALSE(HasFatalFailure());
  const auto begin = std::chrono::steady_clock::now();
  kill(child_, SIGSTOP);
  ASSERT_TRUE(eventually([&] { return !is_enabled(); })) << output();
  const auto off = std::chrono::steady_clock::now() - begin;
  EXPECT_LE(off, 40ms) << "twice guard_ms";
  EXPECT_EQ(finish(std::exchange(child_, -1)), 1000 + SIGKILL);
  EXPECT_TRUE(eventually([&] { return holds(output(), "did not respond; enable line off"); }));
  std::printf("a loop that hangs: power off after %.1f ms\n",
              1e-6 * static_cast<double>(std::chrono::nanoseconds(off).count()));
}

TEST_F(Controller, DryRunClaimsNothing) {
  EXPECT_EQ(run({"--dry-run"}), 0) << output();
  EXPECT_TRUE(holds(output(), "the controller would run")) << output();
  EXPECT_EQ(watchdog("state"), "inactive");
  std::printf("%s", output().c_str());
}

TEST_F(Controller, NamesMistakesWithRemedy) {
  const auto refuses = [&](const std::string& part) {
    EXPECT_EQ(run({"--dry-run"}), 1) << part << "\n" << output();
    EXPECT_TRUE(holds(output(), part) && holds(output(), "the controller would not run"))
        << output();
    EXPECT_EQ(run(), 1) << part;
    EXPECT_TRUE(holds(output(), "error: ") && holds(output(), part)) << output();
    EXPECT_FALSE(is_enabled());
  };
  {
    const auto held = hal::linux_gpio::GpioLines::outputs({"dir1"}, "somebody", false);
    refuses("in use by 'somebody'");
  }
  const json good = file_;
  file_["lines"]["dead_man"] = "hnad";
  refuses("line 'hnad': no chip has a line of that name");
  file_ = good;
  file_["motors"]["axes"][2]["chip"] = "rest.pwm";
  refuses("PWM chip 'rest.pwm': no such device in");
  file_ = good;
  file_["motors"]["axes"][2]["channel"] = 3;
  refuses("it has no channel 3");
  file_ = good;
  file_["watchdog"]["device"] = "/dev/watchdog7";
  refuses("/dev/watchdog7: No such file");
  file_ = good;
  file_["model"] = "cube.blob";
  refuses("cube.blob: cannot be read");
}

TEST_F(Controller, NamesMissingPermission) {
  EXPECT_EQ(run({"--dry-run"}, true), 1);
  EXPECT_TRUE(holds(output(), "permission denied (hint: join the group")) << output();
  EXPECT_EQ(run({}, true), 1);
  EXPECT_TRUE(holds(output(), "permission denied (hint: join the group")) << output();
}

TEST_F(Controller, ClaimsItsLinesExclusively) {
  serve();
  ASSERT_FALSE(HasFatalFailure());
  for (const std::string& name : kLineNames) {
    const hal::linux_gpio::LinePlace place = hal::linux_gpio::find_line(name);
    EXPECT_TRUE(place.used) << name;
    EXPECT_EQ(place.user, "tactree") << name;
  }
  EXPECT_EQ(run(), 1) << "a second process";
  EXPECT_TRUE(holds(output(), "in use by 'tactree'")) << output();
}

}  // namespace
}  // namespace tactree::vm_test

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  if (argc != 3) {
    std::fprintf(stderr, "usage: linux_controller_test TACTREE_CONTROLLER BUNNY_BLOB\n");
    return 2;
  }
  tactree::vm_test::program = argv[1];
  tactree::vm_test::bunny = argv[2];
  // Page faults of this program would delay the loop.
  (void)mlockall(MCL_CURRENT);
  return RUN_ALL_TESTS();
}
