#pragma once
// Motors whose amplifiers have PWM and direction inputs: PWM channels of a Linux computer
// (/sys/class/pwm) and GPIO lines. Only constructors throw: SysfsError or GpioError.

#include <cstdint>
#include <string>
#include <vector>

#include "tactree/hal/board.hpp"
#include "tactree/hal/linux/file_descriptor.hpp"
#include "tactree/hal/linux/gpio_board.hpp"
#include "tactree/hal/linux/gpio_lines.hpp"
#include "tactree/hal/linux/sysfs_error.hpp"

namespace tactree::hal::linux_gpio {

struct MotorLines {
  std::string chip;                   ///< device name of the PWM chip; pwmchip numbers vary
  std::uint32_t channel = 0;          ///< channel of that chip
  std::string direction;              ///< name of the line; high: negative effort
  float effort_at_full_width = 0.0F;  ///< effort at a duty cycle of 1, N or Nm; > 0
};

struct MotorSettings {
  std::string pwm_root = "/sys/class/pwm";
  std::uint32_t period_ns = 50'000;
  std::vector<MotorLines> axes;  ///< 1 .. core::kAxes; all direction lines on one chip
  std::string good = {};         ///< see AmplifiersGood
};

/// Returns the folder of a PWM chip. Throws SysfsError if the chip or the channel is missing; the
/// message lists what is available.
[[nodiscard]] std::string find_pwm_chip(const std::string& root, const std::string& name,
                                        std::uint32_t channel);

/// One PWM channel, exported during the lifetime of this object: no other program can export it.
/// The kernel does not prevent privileged programs from writing to it.
class PwmChannel {
 public:
  PwmChannel(const std::string& root, const std::string& chip, std::uint32_t channel,
             std::uint32_t period_ns);
  ~PwmChannel();
  PwmChannel(PwmChannel&& other) noexcept = default;
  PwmChannel& operator=(PwmChannel&&) = delete;
  PwmChannel(const PwmChannel&) = delete;
  PwmChannel& operator=(const PwmChannel&) = delete;

  /// Sets the pulse width, ns. Returns false if the kernel refuses it. Cost: one system call, none
  /// if the width is unchanged.
  [[nodiscard]] bool set_width(std::uint32_t width_ns) noexcept;

 private:
  std::string chip_;
  std::uint32_t channel_;
  FileDescriptor width_;
  std::uint32_t width_ns_ = 0;
};

/// A MotorBank. Sets zero widths in the constructor and the destructor. If the process is killed,
/// the widths remain: an EnableGuard must switch the power off. For one thread.
class PwmMotors {
 public:
  PwmMotors(const MotorSettings& settings, const std::string& consumer);
  ~PwmMotors() { release(); }
  PwmMotors(const PwmMotors&) = delete;
  PwmMotors& operator=(const PwmMotors&) = delete;

  /// An axis has zero width while its direction changes. Cost: at most three system calls per axis.
  void write(const core::MotorCommand& command) noexcept;
  /// True if no amplifier reports a failure and every width and direction since the start was
  /// written.
  [[nodiscard]] bool healthy() noexcept;
  void release() noexcept;

 private:
  void set_directions(std::uint64_t directions) noexcept;

  std::vector<float> full_;
  std::vector<PwmChannel> channels_;
  GpioLines directions_;
  AmplifiersGood good_;
  std::uint32_t period_ns_;
  std::uint64_t negative_ = 0;  // bit n: axis n is driven in negative direction
  bool delivered_ = true;       // every write since the start succeeded
};

static_assert(MotorBank<PwmMotors>);

}  // namespace tactree::hal::linux_gpio
