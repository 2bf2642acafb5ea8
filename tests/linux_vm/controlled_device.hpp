#pragma once
// A haptic device at the lines of a simulated chip, in a process of its own: quadrature edges and
// switches in, enable line, directions and pulse widths out; or counters and converters, as
// folders. And the hand that holds it.

#include <array>
#include <atomic>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "gpio_sim.hpp"
#include "tactree/core/configuration/device_presets.hpp"

namespace tactree::vm_test {

/// Lines by number, with their names in kLineNames.
enum class Wire : std::uint8_t {
  kA0,
  kB0,
  kIndex0,
  kA1,
  kB1,
  kIndex1,
  kA2,
  kB2,
  kIndex2,
  kDirection0,
  kDirection1,
  kDirection2,
  kEnable,
  kReadBack,
  kEmergencyStop,
  kDeadMan,
  kGood,
  kHeartbeat,
  kBrake,
};
inline const std::vector<std::string> kLineNames = {
    "enc0-a", "enc0-b", "enc0-i", "enc1-a", "enc1-b", "enc1-i", "enc2-a",
    "enc2-b", "enc2-i", "dir0",   "dir1",   "dir2",   "enable", "power",
    "e-stop", "hand",   "good",   "beat",   "brake"};

/// Shared between the test and the device's process.
struct Hands {
  // Actions of people.
  std::array<std::atomic<double>, 3> hand_m{};
  std::atomic<bool> dead_man{false};
  std::atomic<bool> pull_stop{false};  ///< taken back when it was pulled, at its own moment
  std::atomic<bool> release_stop{false};
  std::atomic<int> flips{0};  ///< of track a of axis 0, forth and back, in one go: a bad wire
  std::atomic<bool> end{false};
  // Observations.
  std::array<std::atomic<double>, 3> tip_m{};
  std::array<std::atomic<double>, 3> effort_N{};
  std::atomic<double> effort_max_N{0.0};         ///< of any axis, since it was set to 0
  std::atomic<std::int64_t> stop_to_off_ns{-1};  ///< -1: not measured yet
  std::atomic<std::uint64_t> edges{0};
  std::atomic<std::uint64_t> beats{0};  ///< changes of the heartbeat line
};

/// Cartesian, three axes, an index pulse at 0: as described in the file of the tests.
[[nodiscard]] core::DevicePreset test_device();
inline constexpr float kFullEffort_N = 8.0F;
inline constexpr std::uint32_t kPwmPeriod_ns = 50'000;

/// A folder as /sys/class/pwm has them: the test kernel has no PWM driver.
class PwmFolder {
 public:
  explicit PwmFolder(const std::filesystem::path& folder);
  [[nodiscard]] const std::filesystem::path& root() const { return root_; }
  /// Nanoseconds.
  [[nodiscard]] long width(std::size_t channel) const;

 private:
  std::filesystem::path root_;
  std::vector<hal::FileDescriptor> widths_;
};

/// Folders as /sys/bus/counter/devices and /sys/bus/iio/devices have them: the test kernel has
/// neither counters nor converters.
class AnalogueFolder {
 public:
  explicit AnalogueFolder(const std::filesystem::path& folder);
  [[nodiscard]] const std::filesystem::path& root() const { return root_; }
  void show(std::size_t axis, std::int64_t count) const;
  [[nodiscard]] long code(std::size_t channel) const;

 private:
  std::filesystem::path root_;
  std::vector<hal::FileDescriptor> counts_;
  std::vector<hal::FileDescriptor> codes_;
};
inline constexpr char kCounterDevice[] = "test.counter";
inline constexpr char kConverterDevice[] = "test.dac";
inline constexpr int kZeroCode = 2048;
inline constexpr int kFullCode = 4095;

class ControlledDevice {
 public:
  /// Starts the process. The tip is at `start_m`. `analogue`: where not null, encoders and motors
  /// are there instead of at the lines.
  ControlledDevice(GpioSim& chip, const PwmFolder& pwm, const AnalogueFolder* analogue,
                   const std::array<double, 3>& start_m);
  ~ControlledDevice();
  ControlledDevice(const ControlledDevice&) = delete;
  ControlledDevice& operator=(const ControlledDevice&) = delete;

  [[nodiscard]] Hands& hands() const { return *hands_; }
  /// The hand goes there in a straight line, and this returns when it has arrived.
  void move_hand(const std::array<double, 3>& to_m, double speed_m_s);

 private:
  Hands* hands_;
  pid_t process_;
};

}  // namespace tactree::vm_test
