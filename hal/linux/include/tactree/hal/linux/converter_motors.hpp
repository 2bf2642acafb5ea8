#pragma once
// Motors whose amplifiers have a voltage input, driven by digital-to-analogue converters of a Linux
// computer (industrial I/O, /sys/bus/iio).

#include <cstdint>
#include <string>
#include <vector>

#include "tactree/hal/board.hpp"
#include "tactree/hal/linux/file_descriptor.hpp"
#include "tactree/hal/linux/gpio_board.hpp"
#include "tactree/hal/linux/sysfs_error.hpp"

namespace tactree::hal::linux_gpio {

struct ConverterAxis {
  std::string device;           ///< e.g. "spi0.0"; converter numbers vary
  std::uint32_t channel = 0;    ///< out_voltage<channel> of that device
  std::int32_t zero_code = 0;   ///< code of zero effort
  std::int32_t full_code = 0;   ///< code of effort_at_full
  float effort_at_full = 0.0F;  ///< N or Nm; > 0
};

struct ConverterSettings {
  std::string root = "/sys/bus/iio/devices";
  std::vector<ConverterAxis> axes;  ///< 1 .. core::kAxes
  std::string good = {};            ///< see AmplifiersGood
};

/// Returns the path of the file that takes the codes of a channel. Throws SysfsError if the
/// converter or the channel is missing; the message names the available ones.
[[nodiscard]] std::string find_converter(const std::string& root, const ConverterAxis& axis);

/// Converts an effort to a code, limited to full_code and its mirror image about zero_code. Returns
/// zero_code for NaN.
[[nodiscard]] std::int32_t code_of(const ConverterAxis& axis, float effort);

/// A MotorBank. Writes zero_code in the constructor and the destructor. If the process is killed,
/// the codes remain: an EnableGuard must switch the power off. For one thread.
class ConverterMotors {
 public:
  ConverterMotors(const ConverterSettings& settings, const std::string& consumer);
  ~ConverterMotors() { release(); }
  ConverterMotors(const ConverterMotors&) = delete;
  ConverterMotors& operator=(const ConverterMotors&) = delete;

  /// Cost: at most one system call per axis; its duration depends on the bus of the converter.
  void write(const core::MotorCommand& command) noexcept;
  /// True if no amplifier reports a failure and every code since the start was written.
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
  bool delivered_ = true;  // every write since the start succeeded
};

static_assert(MotorBank<ConverterMotors>);

}  // namespace tactree::hal::linux_gpio
