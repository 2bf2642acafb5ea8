#pragma once
// Motors behind amplifiers that take a pulse width and a direction: PWM channels of a Linux
// computer (/sys/class/pwm) and GPIO lines. Each keeps the contract of board.hpp; constructors
// throw SysfsError or GpioError, nothing else does.

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
  std::string chip;                   ///< by the name of its device: pwmchip numbers change
  std::uint32_t channel = 0;          ///< of that chip
  std::string direction;              ///< line; high: negative effort
  float effort_at_full_width = 0.0F;  ///< N or Nm: above 0
};

struct MotorSettings {
  std::string pwm_root = "/sys/class/pwm";
  std::uint32_t period_ns = 50'000;
  std::vector<MotorLines> axes;  ///< 1 .. core::kAxes; directions on one chip
  std::string good = {};         ///< line, see AmplifiersGood
};

/// The folder of a PWM chip. Throws SysfsError: no such chip (and which there are), no such
/// channel.
[[nodiscard]] std::string find_pwm_chip(const std::string& root, const std::string& name,
                                        std::uint32_t channel);

/// One PWM channel of a chip, taken for as long as this object lives: no other program can export
/// it, but the kernel lets any with the right to do so write to it.
class PwmChannel {
 public:
  PwmChannel(const std::string& root, const std::string& chip, std::uint32_t channel,
             std::uint32_t period_ns);
  ~PwmChannel();
  PwmChannel(PwmChannel&& other) noexcept = default;
  PwmChannel& operator=(PwmChannel&&) = delete;
  PwmChannel(const PwmChannel&) = delete;
  PwmChannel& operator=(const PwmChannel&) = delete;

  /// Nanoseconds of a period. False: the kernel did not take it. Cost: none where it is unchanged,
  /// else one system call.
  [[nodiscard]] bool set_width(std::uint32_t width_ns) noexcept;

 private:
  std::string chip_;
  std::uint32_t channel_;
  FileDescriptor width_;
  std::uint32_t width_ns_ = 0;
};

/// A MotorBank. Widths are zero before the first write and after the last. A process that is killed
/// leaves the widths as they were: it is the enable line that takes the power away.
class PwmMotors {
 public:
  PwmMotors(const MotorSettings& settings, const std::string& consumer);
  ~PwmMotors() { release(); }
  PwmMotors(const PwmMotors&) = delete;
  PwmMotors& operator=(const PwmMotors&) = delete;

  /// Where a direction changes, its width is zero meanwhile. Cost: at most three system calls an
  /// axis.
  void write(const core::MotorCommand& command) noexcept;
  /// No amplifier complains, and the kernel took every width and direction.
  [[nodiscard]] bool healthy() noexcept;
  void release() noexcept;

 private:
  void set_directions(std::uint64_t directions) noexcept;

  std::vector<float> full_;
  std::vector<PwmChannel> channels_;
  GpioLines directions_;
  AmplifiersGood good_;
  std::uint32_t period_ns_;
  std::uint64_t negative_ = 0;  // bit n: axis n is driven that way
  bool delivered_ = true;       // everything, since the start
};

static_assert(MotorBank<PwmMotors>);

}  // namespace tactree::hal::linux_gpio
