#include "controlled_device.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/wait.h>

#include <cmath>
#include <csignal>
#include <cstdlib>
#include <ctime>
#include <new>
#include <thread>

#include "tactree/plant/device_plant.hpp"

namespace tactree::vm_test {
namespace {

constexpr std::int64_t kStep_ns = 1'000'000;
constexpr int kPowerDelaySteps = 5;  // a relay
constexpr std::size_t kAxes = core::kAxes;

std::int64_t now_ns() {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return std::int64_t{now.tv_sec} * 1'000'000'000 + now.tv_nsec;
}

std::size_t number(Wire wire) { return static_cast<std::size_t>(wire); }
std::size_t number(Wire wire, std::size_t axis) { return number(wire) + 3 * axis; }

long number_in(const hal::FileDescriptor& file) {
  std::array<char, 32> text{};
  (void)!::pread(file.get(), text.data(), text.size() - 1, 0);
  return std::strtol(text.data(), nullptr, 10);
}

plant::DevicePlantParameters parameters() {
  plant::DevicePlantParameters p;
  const core::DevicePreset device = test_device();
  p.model = device.model;
  p.dynamics = device.dynamics;
  return p;
}

/// The device's process.
class Device {
 public:
  Device(GpioSim& chip, const PwmFolder& pwm, const AnalogueFolder* analogue, Hands& hands,
         const Eigen::Vector3d& start_m)
      : chip_(chip), pwm_(pwm), analogue_(analogue), hands_(hands), plant_(parameters(), start_m) {
    for (std::size_t i = 0; i < kAxes; ++i) {
      counts_[i] = count_of(i);
      show(i);
    }
  }

  [[noreturn]] void run() {
    std::int64_t due = now_ns();
    while (!hands_.end) {
      switches();
      plant_.advance(effort(), hand(), 1e-9 * static_cast<double>(kStep_ns));
      move_encoders();
      flip();
      tell();
      due += kStep_ns;
      if (now_ns() > due) {
        due = now_ns();  // slower than the clock: its world is slower then
      }
      const timespec until{static_cast<time_t>(due / 1'000'000'000),
                           static_cast<long>(due % 1'000'000'000)};
      clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr);
    }
    _exit(0);
  }

 private:
  [[nodiscard]] std::int64_t count_of(std::size_t axis) const {
    const double per_m = static_cast<double>(test_device().model.counts_per_m[axis]);
    return std::llround(std::floor(plant_.position_m()[static_cast<Eigen::Index>(axis)] * per_m));
  }

  void show(std::size_t axis) {
    const auto quarter = static_cast<std::uint64_t>(counts_[axis]) & 3U;
    const std::array<bool, 2> levels = {quarter == 1U || quarter == 2U, quarter >= 2U};
    for (std::size_t k = 0; k < 2; ++k) {
      if (shown_[axis][k] != levels[k]) {
        shown_[axis][k] = levels[k];
        chip_.pull(number(Wire::kA0, axis) + k, levels[k]);
        ++hands_.edges;
      }
    }
  }

  // One edge at a time, in the order in which they come.
  void move_encoders() {
    for (std::size_t i = 0; i < kAxes; ++i) {
      const std::int64_t to = count_of(i);
      if (analogue_ != nullptr) {
        analogue_->show(i, to);
        continue;
      }
      while (counts_[i] != to) {
        counts_[i] += counts_[i] < to ? 1 : -1;
        show(i);
        if (counts_[i] == 0) {
          chip_.pull(number(Wire::kIndex0, i), true);
          chip_.pull(number(Wire::kIndex0, i), false);
        }
      }
    }
  }

  void flip() {
    const std::size_t track = number(Wire::kA0);
    for (int left = hands_.flips.exchange(0); left > 0; --left) {
      chip_.pull(track, !shown_[0][0]);
      chip_.pull(track, shown_[0][0]);
    }
  }

  // In each step: if a program requests a bias, this chip sets the level to it.
  void switches() {
    chip_.pull(number(Wire::kGood), true);
    chip_.pull(number(Wire::kDeadMan), hands_.dead_man);
    stopped_ = stopped_ && !hands_.release_stop.exchange(false);
    chip_.pull(number(Wire::kEmergencyStop), !stopped_);
    if (hands_.pull_stop.exchange(false)) {
      stopped_ = true;
      const std::int64_t begin = now_ns();
      chip_.pull(number(Wire::kEmergencyStop), false);
      while (chip_.level(number(Wire::kEnable)) && now_ns() - begin < 1'000'000'000) {
      }
      hands_.stop_to_off_ns = now_ns() - begin;
    }
    // A relay switches the power after a delay; its state is that of the motors.
    const bool on = chip_.level(number(Wire::kEnable));
    power_steps_ = on ? power_steps_ + 1 : 0;
    chip_.pull(number(Wire::kReadBack), power_steps_ > kPowerDelaySteps);
  }

  [[nodiscard]] Eigen::Vector3d effort() {
    Eigen::Vector3d effort = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < kAxes; ++i) {
      const bool powered = chip_.level(number(Wire::kEnable)) && power_steps_ > kPowerDelaySteps;
      effort[static_cast<Eigen::Index>(i)] =
          powered ? static_cast<double>(kFullEffort_N) * commanded_share(i) : 0.0;
    }
    return effort_ = effort;
  }

  [[nodiscard]] double commanded_share(std::size_t axis) const {
    if (analogue_ != nullptr) {
      return static_cast<double>(analogue_->code(axis) - kZeroCode) / (kFullCode - kZeroCode);
    }
    const double share = static_cast<double>(pwm_.width(axis)) / kPwmPeriod_ns;
    return chip_.level(number(Wire::kDirection0) + axis) ? -share : share;
  }

  [[nodiscard]] plant::HandTarget hand() const {
    plant::HandTarget target;
    for (std::size_t i = 0; i < kAxes; ++i) {
      target.position_m[static_cast<Eigen::Index>(i)] = hands_.hand_m[i];
    }
    return target;
  }

  void tell() {
    for (std::size_t i = 0; i < kAxes; ++i) {
      const auto axis = static_cast<Eigen::Index>(i);
      hands_.tip_m[i] = plant_.position_m()[axis];
      hands_.effort_N[i] = effort_[axis];
      hands_.effort_max_N = std::max(hands_.effort_max_N.load(), std::abs(effort_[axis]));
    }
    const bool beat = chip_.level(number(Wire::kHeartbeat));
    hands_.beats += beat != beat_ ? 1U : 0U;
    beat_ = beat;
  }

  GpioSim& chip_;
  const PwmFolder& pwm_;
  const AnalogueFolder* analogue_;
  Hands& hands_;
  plant::DevicePlant plant_;
  std::array<std::int64_t, kAxes> counts_{};
  std::array<std::array<bool, 2>, kAxes> shown_{};
  Eigen::Vector3d effort_ = Eigen::Vector3d::Zero();
  int power_steps_ = 0;
  bool beat_ = false;
  bool stopped_ = false;
};

}  // namespace

core::DevicePreset test_device() {
  core::DevicePreset device = core::presets::cartesian();
  for (std::size_t i = 0; i < kAxes; ++i) {
    device.model.counts_per_m[i] = 10000.0F;
    device.model.joint_min[i] = -0.2F;
    device.model.joint_max[i] = 0.2F;
    device.model.home_position[i] = 0.0F;
  }
  device.model.homing = core::HomingMethod::kIndex;
  return device;
}

PwmFolder::PwmFolder(const std::filesystem::path& folder) : root_(folder / "pwm") {
  std::filesystem::create_directories(root_ / "pwmchip4");
  std::filesystem::create_directories(folder / "devices/test.pwm");
  std::filesystem::create_directory_symlink(folder / "devices/test.pwm", root_ / "pwmchip4/device");
  std::ofstream(root_ / "pwmchip4/npwm") << kAxes << "\n";
  std::ofstream(root_ / "pwmchip4/export").flush();
  std::ofstream(root_ / "pwmchip4/unexport").flush();
  for (std::size_t i = 0; i < kAxes; ++i) {
    const std::filesystem::path channel = root_ / ("pwmchip4/pwm" + std::to_string(i));
    std::filesystem::create_directories(channel);
    for (const char* const file : {"period", "duty_cycle", "enable"}) {
      std::ofstream(channel / file) << "0\n";
    }
    widths_.emplace_back(::open((channel / "duty_cycle").c_str(), O_RDONLY | O_CLOEXEC));
  }
}

long PwmFolder::width(std::size_t channel) const { return number_in(widths_[channel]); }

AnalogueFolder::AnalogueFolder(const std::filesystem::path& folder) : root_(folder / "bus") {
  const auto add = [&](const std::string& device, const std::string& entry) {
    std::filesystem::create_directories(folder / device / entry);
    std::filesystem::create_directories(root_);
    std::filesystem::create_directory_symlink(folder / device / entry, root_ / entry);
    return folder / device / entry;
  };
  const std::filesystem::path counter = add(kCounterDevice, "counter0");
  const std::filesystem::path converter = add(kConverterDevice, "iio:device0");
  for (std::size_t i = 0; i < kAxes; ++i) {
    const std::filesystem::path count = counter / ("count" + std::to_string(i));
    std::filesystem::create_directories(count);
    std::ofstream(count / "function").flush();
    for (const char* const file : {"enable", "ceiling", "count"}) {
      std::ofstream(count / file) << "0\n";
    }
    counts_.emplace_back(::open((count / "count").c_str(), O_WRONLY | O_CLOEXEC));
    const std::filesystem::path code = converter / ("out_voltage" + std::to_string(i) + "_raw");
    std::ofstream(code) << "0\n";
    codes_.emplace_back(::open(code.c_str(), O_RDONLY | O_CLOEXEC));
  }
}

// One write: a reader sees the count before or after it.
void AnalogueFolder::show(std::size_t axis, std::int64_t count) const {
  const std::string text = std::to_string(static_cast<std::uint32_t>(count)) + "\n";
  (void)!::pwrite(counts_[axis].get(), text.data(), text.size(), 0);
}

long AnalogueFolder::code(std::size_t channel) const { return number_in(codes_[channel]); }

ControlledDevice::ControlledDevice(GpioSim& chip, const PwmFolder& pwm,
                                   const AnalogueFolder* analogue,
                                   const std::array<double, 3>& start_m) {
  void* const memory =
      mmap(nullptr, sizeof(Hands), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  hands_ = new (memory) Hands;
  for (std::size_t i = 0; i < kAxes; ++i) {
    hands_->hand_m[i] = start_m[i];
  }
  process_ = fork();
  if (process_ == 0) {
    Device(chip, pwm, analogue, *hands_, {start_m[0], start_m[1], start_m[2]}).run();
  }
}

ControlledDevice::~ControlledDevice() {
  hands_->end = true;
  waitpid(process_, nullptr, 0);
  munmap(hands_, sizeof(Hands));
}

void ControlledDevice::move_hand(const std::array<double, 3>& to_m, double speed_m_s) {
  constexpr double kTick_s = 1e-3;
  std::array<double, 3> from{};
  double squared_m2 = 0.0;
  for (std::size_t i = 0; i < kAxes; ++i) {
    from[i] = hands_->hand_m[i];
    squared_m2 += (to_m[i] - from[i]) * (to_m[i] - from[i]);
  }
  const int steps = 1 + static_cast<int>(std::sqrt(squared_m2) / speed_m_s / kTick_s);
  for (int k = 1; k <= steps; ++k) {
    for (std::size_t i = 0; i < kAxes; ++i) {
      hands_->hand_m[i] = from[i] + (to_m[i] - from[i]) * k / steps;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

}  // namespace tactree::vm_test
