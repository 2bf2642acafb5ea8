// tactree-controller in a real kernel, against a device in a process of its own.
//
// usage: linux_controller_test TACTREE_CONTROLLER BUNNY_BLOB
//        (as root, in the test kernel, virtual time)

#include <fcntl.h>
#include <grp.h>
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/wait.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <random>
#include <sstream>
#include <thread>

#include "controlled_device.hpp"
#include "tactree/hal/linux/gpio_lines.hpp"
#include "tactree/host/board.hpp"
#include "tactree/host/local_socket.hpp"
#include "tactree/host/usb_devices.hpp"
#include "tactree/host/usb_transport.hpp"
#include "test_models.hpp"

namespace tactree::vm_test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using namespace std::chrono_literals;

std::string program;  // NOLINT: of the command line
std::string bunny;    // NOLINT

constexpr double kRadius_m = 0.03;
constexpr double kHand_N_m = 300.0;  // how stiff plant::HandTarget is
constexpr double kRate_hz = 1000.0;
constexpr double kPeriod_ns = 1e9 / kRate_hz;

std::string contents(const fs::path& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

bool holds(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

template <class Condition>
bool eventually(Condition condition) {
  for (int i = 0; i < 5000; ++i) {  // virtual milliseconds
    if (condition()) {
      return true;
    }
    std::this_thread::sleep_for(1ms);
  }
  return false;
}

json axes(std::initializer_list<json> list) { return json(list); }

class Controller : public testing::Test {
 protected:
  explicit Controller(bool analogue = false) {
    if (analogue) {
      analogue_.emplace(folder_);
    }
    device_.emplace(chip_, pwm_, analogue ? &*analogue_ : nullptr,
                    std::array<double, 3>{-0.05, -0.05, 0.05});
  }

  void SetUp() override {
    write_device("index");
    const test::TestBlob blob(test::sphere(kRadius_m, 3e-3));
    const std::vector<std::byte>& bytes = blob.written().bytes;
    std::ofstream(folder_ / "sphere.blob", std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()),
               static_cast<std::streamsize>(bytes.size()));
    file_ = {{"device", "device.json"},
             {"model", "sphere.blob"},
             {"rate_hz", kRate_hz},
             {"limits", {{"force_max_N", 3.0}, {"link_required", true}, {"link_timeout_s", 0.1}}},
             {"encoders",
              {{"axes", axes({{{"a", "enc0-a"}, {"b", "enc0-b"}, {"index", "enc0-i"}},
                              {{"a", "enc1-a"}, {"b", "enc1-b"}, {"index", "enc1-i"}},
                              {{"a", "enc2-a"}, {"b", "enc2-b"}, {"index", "enc2-i"}}})}}},
             {"motors",
              {{"pwm_root", pwm_.root().string()},
               {"period_ns", kPwmPeriod_ns},
               {"good", "good"},
               {"axes", axes({motor(0), motor(1), motor(2)})}}},
             {"lines",
              {{"enable", "enable"},
               {"enable_read_back", "power"},
               {"emergency_stop", "e-stop"},
               {"dead_man", "hand"},
               {"heartbeat", "beat"},
               {"brake", "brake"}}},
             {"watchdog", {{"device", "/dev/watchdog0"}, {"timeout_s", 60}}},
             {"real_time", {{"priority", 80}, {"required", true}, {"guard_ms", 20}}},
             {"socket", socket_}};
  }
  void TearDown() override {
    if (child_ > 0) {
      kill(child_, SIGKILL);
      waitpid(child_, nullptr, 0);
    }
    stop_watchdog();
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
  }

  static json motor(int axis) {
    return {{"chip", "test.pwm"},
            {"channel", axis},
            {"direction", "dir" + std::to_string(axis)},
            {"effort_at_full_width", kFullEffort_N}};
  }

  void write_device(const char* homing) {
    const core::DevicePreset device = test_device();
    const core::DeviceModel& m = device.model;
    const auto list = [](const float(&v)[3]) { return json{v[0], v[1], v[2]}; };
    const json text = {{"name", "test"},
                       {"about", "three linear axes"},
                       {"kind", "cartesian"},
                       {"homing", homing},
                       {"counts_per_m", list(m.counts_per_m)},
                       {"ratio", list(m.ratio)},
                       {"home_position", list(m.home_position)},
                       {"joint_min", list(m.joint_min)},
                       {"joint_max", list(m.joint_max)},
                       {"joint_margin", list(m.joint_margin)},
                       {"origin_m", {m.origin_m.x, m.origin_m.y, m.origin_m.z}},
                       {"link_mass_kg", list(m.link_mass_kg)},
                       {"link_centre_m", list(m.link_centre_m)},
                       {"tip_mass_kg", m.tip_mass_kg},
                       {"torque_constant_Nm_per_ampere", list(m.torque_constant_Nm_per_ampere)},
                       {"force_max_N", device.drive.force_max_N},
                       {"effort_max", list(device.drive.effort_max)},
                       {"damping_Ns_m", device.drive.damping_Ns_m},
                       {"inertia", list(device.dynamics.inertia)},
                       {"viscous", list(device.dynamics.viscous)},
                       {"coulomb", list(device.dynamics.coulomb)}};
    std::ofstream(folder_ / "device.json") << text;
  }

  pid_t start(const std::vector<std::string>& options = {}, bool as_nobody = false) {
    std::ofstream(folder_ / "controller.json") << file_.dump(1);
    fs::permissions(folder_, fs::perms::all);
    const pid_t child = fork();
    if (child != 0) {
      return child;
    }
    const int out = open((folder_ / "out").c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0666);
    dup2(out, STDOUT_FILENO);
    dup2(out, STDERR_FILENO);
    if (as_nobody && (setgroups(0, nullptr) != 0 || setgid(65534) != 0 || setuid(65534) != 0)) {
      _exit(99);
    }
    const std::string file = folder_ / "controller.json";
    std::vector<char*> arguments = {program.data(), const_cast<char*>(file.c_str())};  // NOLINT
    for (const std::string& option : options) {
      arguments.push_back(const_cast<char*>(option.c_str()));  // NOLINT
    }
    arguments.push_back(nullptr);
    execv(program.c_str(), arguments.data());
    _exit(98);
  }

  int finish(pid_t child) {
    int status = 0;
    waitpid(child, &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : 1000 + WTERMSIG(status);
  }

  /// Exit code of a run that ends by itself; what it said is in output().
  int run(const std::vector<std::string>& options = {}, bool as_nobody = false) {
    return finish(start(options, as_nobody));
  }
  [[nodiscard]] std::string output() const { return contents(folder_ / "out"); }

  /// What it has to say for itself while it runs.
  [[nodiscard]] std::string report() const {
    kill(child_, SIGUSR1);
    std::this_thread::sleep_for(50ms);
    return output();
  }

  void serve() {
    child_ = start();
    ASSERT_TRUE(eventually([&] { return holds(output(), "serving"); })) << output();
    connect();
    // The simulated chip lets go of its switches for a moment while they are requested.
    std::this_thread::sleep_for(20ms);
    board_->clear_faults();
  }

  virtual void connect() {
    board_ = std::make_unique<host::Board>(host::open_local_socket(socket_),
                                           host::BoardOptions{115200, 100});
  }

  /// Over the index pulse of each axis.
  virtual void find_home() {
    device_->move_hand({0.05, -0.05, 0.05}, 0.2);
    device_->move_hand({0.05, 0.05, 0.05}, 0.2);
    device_->move_hand({0.05, 0.05, -0.01}, 0.2);
  }

  /// And then above the model.
  void home() {
    find_home();
    ASSERT_TRUE(eventually([&] {
      return (board_->capabilities().flags &
              static_cast<std::uint32_t>(core::wire::BoardFlag::kHomed)) != 0U;
    })) << output();
    device_->move_hand({0.05, 0.05, above_m_}, 0.2);
    device_->move_hand({0.0, 0.0, above_m_}, 0.2);
    ASSERT_EQ(host::names_of(board_->state().faults), "") << output();
  }

  void arm() {
    board_->begin_arming();
    std::this_thread::sleep_for(20ms);
    hands().dead_man = true;
    ASSERT_TRUE(eventually([&] { return board_->state().state == kActive; }))
        << "faults: " << host::names_of(board_->state().faults) << "\n"
        << "limits: " << board_->state().limits << ", probe z: " << board_->state().probe_m[2]
        << ", tip z: " << hands().tip_m[2] << "\n"
        << report();
  }

  /// Until there is a force.
  void press() {
    device_->move_hand({0.0, 0.0, kRadius_m - 0.005}, 0.2);
    ASSERT_TRUE(eventually([&] { return hands().effort_N[2] > 0.5; }))
        << "faults: " << host::names_of(board_->state().faults) << ", tip z: " << hands().tip_m[2]
        << "\n"
        << report();
  }

  /// Served, homed, armed, and in contact.
  void hold() {
    serve();
    home();
    arm();
    press();
    ASSERT_FALSE(HasFatalFailure());
    ASSERT_TRUE(is_enabled());
  }

  static std::string watchdog(const char* what) {
    std::string text = contents(fs::path("/sys/class/watchdog/watchdog0") / what);
    std::erase(text, '\n');
    return text;
  }
  /// What a killed program leaves running would end the test kernel.
  static void stop_watchdog() {
    const int file = open("/dev/watchdog0", O_WRONLY | O_CLOEXEC);
    if (file >= 0) {
      (void)!::write(file, "V", 1);
      close(file);
    }
  }

  [[nodiscard]] bool is_enabled() const {
    const bool enabled = chip_.level(static_cast<std::size_t>(Wire::kEnable));
    EXPECT_EQ(chip_.level(static_cast<std::size_t>(Wire::kBrake)), enabled) << "brakes are closed";
    return enabled;
  }

  [[nodiscard]] Hands& hands() const { return device_->hands(); }

  /// By its last report.
  void expect_undisturbed() const {
    EXPECT_TRUE(holds(output(),
                      "page faults after the start: 0 minor, 0 major; "
                      "allocations after the start: 0\n"))
        << output();
  }

  /// What the hand gives, the motors hold.
  void expect_balance(double hand_z_m) const {
    const std::array<double, 3> hand = {hands().hand_m[0], hands().hand_m[1], hand_z_m};
    for (std::size_t i = 0; i < hand.size(); ++i) {
      EXPECT_NEAR(hands().effort_N[i], kHand_N_m * (hands().tip_m[i] - hand[i]), 0.15) << i;
    }
  }

  static constexpr auto kActive = static_cast<std::uint8_t>(core::State::kActive);

  fs::path folder_ = [] {
    std::string name = "/run/controller-XXXXXX";
    return fs::path(mkdtemp(name.data()));
  }();
  std::string socket_ = folder_ / "socket";
  json file_;
  GpioSim chip_{"board", kLineNames};
  PwmFolder pwm_{folder_};
  std::optional<AnalogueFolder> analogue_;
  std::optional<ControlledDevice> device_;
  double above_m_ = 0.05;  // the model, in the middle
  pid_t child_ = -1;
  std::unique_ptr<host::Board> board_;
};

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

/// Down to a touch, 3 mm further, and over the surface.
TEST_F(Controller, TheBunnyIsFelt) {
  file_["model"] = bunny;
  above_m_ = 0.1;
  serve();
  ASSERT_FALSE(HasFatalFailure());
  home();
  ASSERT_FALSE(HasFatalFailure());
  arm();
  ASSERT_FALSE(HasFatalFailure());
  const auto push_N = [&] {
    return std::hypot(hands().effort_N[0], hands().effort_N[1], hands().effort_N[2]);
  };
  double z_m = above_m_;
  while (push_N() < 0.3 && z_m > -above_m_) {
    z_m -= 0.001;
    device_->move_hand({0.0, 0.0, z_m}, 0.05);
  }
  ASSERT_GT(z_m, -above_m_) << "nothing is there";
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

/// More edges than the kernel keeps from one look to the next: the loop stands still meanwhile, for
/// less than its guard allows.
TEST_F(Controller, EdgesBeyondWhatTheKernelKeepsAreAFault) {
  file_["real_time"]["guard_ms"] = 1000;
  serve();
  ASSERT_FALSE(HasFatalFailure());
  home();
  ASSERT_FALSE(HasFatalFailure());
  arm();
  ASSERT_FALSE(HasFatalFailure());
  hands().flips = 200;
  std::this_thread::sleep_for(100ms);
  EXPECT_EQ(board_->state().state, kActive) << "what it can bear, it bears";
  kill(child_, SIGSTOP);
  hands().flips = 4000;
  EXPECT_TRUE(eventually([&] { return hands().flips == 0; }));
  std::this_thread::sleep_for(200ms);
  kill(child_, SIGCONT);
  ASSERT_TRUE(eventually([&] { return !is_enabled(); })) << report();
  const auto is_invalid = [&] {
    return core::has_fault(board_->state().faults, core::Fault::kEncoderInvalid);
  };
  EXPECT_TRUE(eventually(is_invalid)) << host::names_of(board_->state().faults);
  const std::string text = report();
  EXPECT_TRUE(holds(text, "encoder edges lost: ") && !holds(text, "encoder edges lost: 0\n"))
      << text;
  board_->clear_faults();
  std::this_thread::sleep_for(50ms);
  EXPECT_TRUE(is_invalid()) << "where the axis is, nobody knows: until it starts anew";
}

/// Counters, converters; homed in a given pose.
class AnalogueController : public Controller {
 protected:
  AnalogueController() : Controller(true) {}

  void SetUp() override {
    Controller::SetUp();
    write_device("given-pose");
    const auto axis = [](int i) {
      return json{{"converter", kConverterDevice},
                  {"channel", i},
                  {"zero_code", kZeroCode},
                  {"full_code", kFullCode},
                  {"effort_at_full", kFullEffort_N}};
    };
    const auto counter = [](int i) { return json{{"counter", kCounterDevice}, {"count", i}}; };
    file_["encoders"] = {{"counter_root", analogue_->root().string()},
                         {"axes", axes({counter(0), counter(1), counter(2)})}};
    file_["motors"] = {{"converter_root", analogue_->root().string()},
                       {"good", "good"},
                       {"axes", axes({axis(0), axis(1), axis(2)})}};
  }

  void find_home() override {
    device_->move_hand({0.0, 0.0, 0.0}, 0.2);
    std::this_thread::sleep_for(500ms);
    board_->home();
  }
};

TEST_F(AnalogueController, HomesArmsRendersAndStops) {
  EXPECT_EQ(run({"--dry-run"}), 0) << output();
  EXPECT_TRUE(holds(output(), "encoders at counters")) << output();
  hold();
  ASSERT_FALSE(HasFatalFailure());
  std::this_thread::sleep_for(300ms);
  expect_balance(kRadius_m - 0.005);
  EXPECT_EQ(hands().edges, 0U);
  EXPECT_EQ(board_->state().state, kActive);
  EXPECT_NEAR(static_cast<double>(board_->state().probe_m[2]), hands().tip_m[2], 0.001);
  kill(child_, SIGTERM);
  EXPECT_EQ(finish(std::exchange(child_, -1)), 0) << output();
  EXPECT_FALSE(is_enabled());
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(analogue_->code(i), kZeroCode);
  }
  expect_undisturbed();
}

TEST_F(AnalogueController, WhatIsWrongIsNamedWithCauseAndRemedy) {
  const auto refuses = [&](const std::string& part) {
    EXPECT_EQ(run(), 1) << part;
    EXPECT_TRUE(holds(output(), "error: ") && holds(output(), part)) << part << "\n" << output();
    EXPECT_FALSE(is_enabled());
  };
  const json good = file_;
  file_["encoders"]["axes"][1]["counter"] = "rest.counter";
  refuses("counter 'rest.counter': none in");
  file_ = good;
  file_["encoders"]["axes"][1]["count"] = 3;
  refuses("it has no count 3");
  file_ = good;
  file_["encoders"]["axes"][1] = {{"a", "enc1-a"}, {"b", "enc1-b"}};
  refuses("is there for some axes only");
  file_ = good;
  file_["motors"]["axes"][0]["converter"] = "rest.dac";
  refuses("converter 'rest.dac': none in");
  file_ = good;
  file_["motors"]["axes"][0]["channel"] = 3;
  refuses("it has no output 3");
  file_ = good;
  file_["motors"]["axes"][0]["zero_code"] = 100;
  refuses("leaves no room for efforts the other way");
  file_ = good;
  write_device("index");
  refuses("counters tell no index pulse");
}

/// The link at the USB device port of this computer; its other end is here as well.
class UsbController : public Controller {
 protected:
  void SetUp() override {
    Controller::SetUp();
    file_.erase("socket");
    file_["usb"] = {{"port", "dummy_udc.0"}, {"serial", 77}};
  }
  void connect() override {
    std::string why;
    ASSERT_TRUE(eventually([&] {
      try {
        board_ = std::make_unique<host::Board>(host::open_usb(""), host::BoardOptions{115200, 100});
      } catch (const std::runtime_error& error) {
        why = error.what();
      }
      return board_ != nullptr;
    })) << why;
  }
  static std::size_t gadgets() {
    const auto folder = fs::directory_iterator("/sys/kernel/config/usb_gadget");
    return static_cast<std::size_t>(std::distance(begin(folder), end(folder)));
  }
};

TEST_F(UsbController, HomesArmsRendersAndStops) {
  EXPECT_EQ(run({"--dry-run"}), 0) << output();
  EXPECT_TRUE(holds(output(), "dummy_udc.0")) << output();
  hold();
  ASSERT_FALSE(HasFatalFailure());
  EXPECT_EQ(host::list_usb_devices().at(0).serial, "00000000000000000000004D");
  std::this_thread::sleep_for(300ms);
  expect_balance(kRadius_m - 0.005);
  EXPECT_EQ(board_->state().state, kActive);
  board_->stop();
  EXPECT_TRUE(eventually([&] { return !is_enabled(); }));
  kill(child_, SIGTERM);
  EXPECT_EQ(finish(std::exchange(child_, -1)), 0) << output();
  expect_undisturbed();
  EXPECT_EQ(gadgets(), 0U) << "it is taken down again";
}

TEST_F(UsbController, WhatAKilledOneLeftIsTakenDown) {
  hold();
  ASSERT_FALSE(HasFatalFailure());
  kill(child_, SIGKILL);
  EXPECT_EQ(finish(std::exchange(child_, -1)), 1000 + SIGKILL);
  ASSERT_TRUE(eventually([&] { return !is_enabled(); }));
  EXPECT_EQ(gadgets(), 1U);
  board_.reset();
  hands().dead_man = false;
  serve();
  ASSERT_FALSE(HasFatalFailure());
  EXPECT_EQ(gadgets(), 1U) << "its own";
  EXPECT_EQ(board_->state().faults, 0U) << host::names_of(board_->state().faults);
}

TEST_F(UsbController, APortThatIsNotThereIsNamed) {
  file_["usb"]["port"] = "none.0";
  EXPECT_EQ(run({"--dry-run"}), 1);
  EXPECT_TRUE(holds(output(), "no USB device port is 'none.0' (remedy: name one of: dummy_udc.0"))
      << output();
  EXPECT_EQ(run(), 1);
  file_["socket"] = socket_;
  EXPECT_EQ(run(), 1);
  EXPECT_TRUE(holds(output(), "exactly one of socket and usb")) << output();
}

TEST_F(Controller, TheEmergencyStopTakesThePowerWithinTwoTicks) {
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
    EXPECT_FALSE(is_enabled()) << "released, it stays off";
    board_->clear_faults();
  }
  std::printf("emergency stop: 20 times, power off after at most %.3f ms\n",
              1e-6 * static_cast<double>(longest));
}

TEST_F(Controller, KilledItLeavesTheEnableLineOff) {
  hold();
  ASSERT_FALSE(HasFatalFailure());
  kill(child_, SIGKILL);
  EXPECT_EQ(finish(std::exchange(child_, -1)), 1000 + SIGKILL);
  ASSERT_TRUE(eventually([&] {
    return holds(output(), "the control loop is gone; enable line off");
  })) << output();
  EXPECT_FALSE(is_enabled());
  EXPECT_EQ(watchdog("state"), "active") << "and the watchdog runs on";
  std::this_thread::sleep_for(50ms);
  hands().effort_max_N = 0.0;
  std::this_thread::sleep_for(50ms);
  EXPECT_EQ(hands().effort_max_N, 0.0);
  EXPECT_EQ(run({"--off"}), 0) << output();
  EXPECT_TRUE(holds(output(), "line 'enable' is off"));
  EXPECT_FALSE(is_enabled());
}

/// The kernel takes no line from a program that hangs: it is the guard that does.
TEST_F(Controller, HangingItIsEndedByItsGuard) {
  hold();
  ASSERT_FALSE(HasFatalFailure());
  const auto begin = std::chrono::steady_clock::now();
  kill(child_, SIGSTOP);
  ASSERT_TRUE(eventually([&] { return !is_enabled(); })) << output();
  const auto off = std::chrono::steady_clock::now() - begin;
  EXPECT_LE(off, 40ms) << "twice guard_ms";
  EXPECT_EQ(finish(std::exchange(child_, -1)), 1000 + SIGKILL);
  EXPECT_TRUE(eventually([&] { return holds(output(), "was silent; enable line off"); }));
  std::printf("a loop that hangs: power off after %.1f ms\n",
              1e-6 * static_cast<double>(std::chrono::nanoseconds(off).count()));
}

TEST_F(Controller, ADryRunLooksAndTakesNothing) {
  EXPECT_EQ(run({"--dry-run"}), 0) << output();
  EXPECT_TRUE(holds(output(), "it would run")) << output();
  EXPECT_EQ(watchdog("state"), "inactive");
  std::printf("%s", output().c_str());
}

TEST_F(Controller, WhatIsWrongIsNamedWithCauseAndRemedy) {
  const auto refuses = [&](const std::string& part) {
    EXPECT_EQ(run({"--dry-run"}), 1) << part << "\n" << output();
    EXPECT_TRUE(holds(output(), part) && holds(output(), "it would not run")) << output();
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
  refuses("PWM chip 'rest.pwm': none in");
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

TEST_F(Controller, WhoMayNotIsToldSo) {
  EXPECT_EQ(run({"--dry-run"}, true), 1);
  EXPECT_TRUE(holds(output(), "permission denied (remedy: join the group")) << output();
  EXPECT_EQ(run({}, true), 1);
  EXPECT_TRUE(holds(output(), "permission denied (remedy: join the group")) << output();
}

TEST_F(Controller, TheLinesAreOursAndNobodyElses) {
  serve();
  ASSERT_FALSE(HasFatalFailure());
  for (const std::string& name : kLineNames) {
    const hal::linux_gpio::LinePlace place = hal::linux_gpio::find_line(name);
    EXPECT_TRUE(place.used) << name;
    EXPECT_EQ(place.user, "tactree") << name;
  }
  EXPECT_EQ(run(), 1) << "a second one";
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
  // Pages of this program that are read in meanwhile would hold the loop up: the kernel does it in
  // one go.
  (void)mlockall(MCL_CURRENT);
  return RUN_ALL_TESTS();
}
