#pragma once
// tactree-controller in a real kernel, connected to a device that is simulated in another process.

#include <fcntl.h>
#include <grp.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <chrono>
#include <csignal>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>
#include <thread>

#include "controlled_device.hpp"
#include "tactree/client/board.hpp"
#include "tactree/client/local_socket.hpp"
#include "test_models.hpp"

namespace tactree::vm_test {

namespace fs = std::filesystem;
using nlohmann::json;
using namespace std::chrono_literals;

inline std::string program;  // NOLINT: set by main()
inline std::string bunny;    // NOLINT

inline constexpr double kRadius_m = 0.03;
inline constexpr double kHand_N_m = 300.0;  // stiffness of plant::HandTarget
inline constexpr double kRate_hz = 1000.0;
inline constexpr double kPeriod_ns = 1e9 / kRate_hz;

inline std::string contents(const fs::path& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

inline bool holds(const std::string& text, const std::string& part) {
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

inline json axes(std::initializer_list<json> list) { return json(list); }

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

  /// Runs the program until it ends by itself, and returns its exit code.
  int run(const std::vector<std::string>& options = {}, bool as_nobody = false) {
    return finish(start(options, as_nobody));
  }
  [[nodiscard]] std::string output() const { return contents(folder_ / "out"); }

  /// Output of the running program, after a request to report.
  [[nodiscard]] std::string report() const {
    kill(child_, SIGUSR1);
    std::this_thread::sleep_for(50ms);
    return output();
  }

  void serve() {
    child_ = start();
    ASSERT_TRUE(eventually([&] { return holds(output(), "serving"); })) << output();
    connect();
    // The simulated chip releases its switches for a moment while they are requested.
    std::this_thread::sleep_for(20ms);
    board_->clear_faults();
  }

  virtual void connect() {
    board_ = std::make_unique<client::Board>(client::open_local_socket(socket_),
                                             client::BoardOptions{115200, 100});
  }

  /// Moves over the index pulse of each axis.
  virtual void find_home() {
    device_->move_hand({0.05, -0.05, 0.05}, 0.2);
    device_->move_hand({0.05, 0.05, 0.05}, 0.2);
    device_->move_hand({0.05, 0.05, -0.01}, 0.2);
  }

  /// Finds home and moves above the model.
  void home() {
    find_home();
    ASSERT_TRUE(eventually([&] {
      return (board_->capabilities().flags &
              static_cast<std::uint32_t>(core::wire::BoardFlag::kHomed)) != 0U;
    })) << output();
    device_->move_hand({0.05, 0.05, above_m_}, 0.2);
    device_->move_hand({0.0, 0.0, above_m_}, 0.2);
    ASSERT_EQ(client::names_of(board_->state().faults), "") << report();
  }

  void arm() {
    board_->begin_arming();
    std::this_thread::sleep_for(20ms);
    hands().dead_man = true;
    ASSERT_TRUE(eventually([&] { return board_->state().state == kActive; }))
        << "faults: " << client::names_of(board_->state().faults) << "\n"
        << "limits: " << board_->state().limits << ", probe z: " << board_->state().probe_m[2]
        << ", tip z: " << hands().tip_m[2] << "\n"
        << report();
  }

  /// Presses until the force exceeds 0.5 N.
  void press() {
    device_->move_hand({0.0, 0.0, kRadius_m - 0.005}, 0.2);
    ASSERT_TRUE(eventually([&] { return hands().effort_N[2] > 0.5; }))
        << "faults: " << client::names_of(board_->state().faults) << ", tip z: " << hands().tip_m[2]
        << "\n"
        << report();
  }

  /// Serves, homes and arms.
  void activate() {
    serve();
    home();
    arm();
  }

  /// Serves, homes, arms and presses.
  void hold() {
    activate();
    press();
    ASSERT_FALSE(HasFatalFailure());
    ASSERT_TRUE(is_enabled());
  }

  static std::string watchdog(const char* what) {
    std::string text = contents(fs::path("/sys/class/watchdog/watchdog0") / what);
    std::erase(text, '\n');
    return text;
  }
  /// A watchdog that a killed program left running would reset the test kernel.
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

  /// According to the last report.
  void expect_undisturbed() const {
    EXPECT_TRUE(holds(output(),
                      "page faults after the start: 0 minor, 0 major; "
                      "allocations after the start: 0\n"))
        << output();
  }

  /// The motors hold the force of the hand.
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
  std::unique_ptr<client::Board> board_;
};

}  // namespace tactree::vm_test
