#pragma once
// Motors behind amplifiers that take a voltage: digital-to-analogue converters of a Linux computer
// (industrial I/O, /sys/bus/iio).

#include <cstdint>
#include <string>
#include <vector>

#include "tactree/hal/board.hpp"
#include "tactree/hal/linux/file_descriptor.hpp"
#include "tactree/hal/linux/gpio_board.hpp"
#include "tactree/hal/linux/sysfs_error.hpp"

namespace tactree::hal::linux_gpio {

struct ConverterAxis {
  std::string device;           ///< as in "spi0.0": the numbers of converters change
  std::uint32_t channel = 0;    ///< of that device: out_voltage<channel>
  std::int32_t zero_code = 0;   ///< at which the amplifier gives no effort
  std::int32_t full_code = 0;   ///< at which it gives effort_at_full
  float effort_at_full = 0.0F;  ///< N or Nm: above 0
};

struct ConverterSettings {
  std::string root = "/sys/bus/iio/devices";
  std::vector<ConverterAxis> axes;  ///< 1 .. core::kAxes
  std::string good = {};            ///< line, see AmplifiersGood
};

/// The file that a channel's code is written to. Throws SysfsError: no such converter (and which
/// there are), no such channel.
[[nodiscard]] std::string find_converter(const std::string& root, const ConverterAxis& axis);

/// The code for an effort; never beyond full_code or its mirror image at zero_code. What is no
/// number is no effort.
[[nodiscard]] std::int32_t code_of(const ConverterAxis& axis, float effort);

/// A MotorBank. Codes are those of no effort before the first write and after the last. A process
/// that is killed leaves the codes as they were: it is the enable line that takes the power away.
class ConverterMotors {
 public:
  ConverterMotors(const ConverterSettings& settings, const std::string& consumer);
  ~ConverterMotors() { release(); }
  ConverterMotors(const ConverterMotors&) = delete;
  ConverterMotors& operator=(const ConverterMotors&) = delete;

  /// Cost: at most one system call an axis; the converter's bus decides how long it takes.
  void write(const core::MotorCommand& command) noexcept;
  /// No amplifier complains, and the kernel took every code.
  [[nodiscard]] bool healthy() noexcept;
  void release() noexcept;

 private:
  struct Output {
    ConverterAxis axis;
    FileDescriptor file;
    std::int32_t code = 0;
  };
  void give(Output& output, std::int32_t code) noexcept;

  std::vector<Output> outputs_;
  AmplifiersGood good_;
  bool delivered_ = true;  // everything, since the start
};

static_assert(MotorBank<ConverterMotors>);

}  // namespace tactree::hal::linux_gpio
