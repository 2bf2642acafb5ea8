#pragma once
// Encoders on the quadrature counters of a Linux computer (/sys/bus/counter). The hardware counts
// every edge, even while the program is late.

#include <cstdint>
#include <string>
#include <vector>

#include "tactree/hal/board.hpp"
#include "tactree/hal/linux/file_descriptor.hpp"
#include "tactree/hal/linux/sysfs_error.hpp"

namespace tactree::hal::linux_gpio {

struct CounterAxis {
  std::string device;       ///< e.g. "48300180.counter"; counter numbers vary
  std::uint32_t count = 0;  ///< the folder count<count> of that device
};

struct CounterSettings {
  std::string root = "/sys/bus/counter/devices";
  std::vector<CounterAxis> axes;  ///< 1 .. core::kAxes
};

/// Returns the folder of a count. Throws SysfsError if the counter or the count is missing; the
/// message names the available ones.
[[nodiscard]] std::string find_count(const std::string& root, const CounterAxis& axis);

/// An EncoderBank without index pulses; axes without a counter read 0. Extends counters of fewer
/// than 32 bits; precondition: between two reads a counter moves by less than half its range. The
/// axes are read some microseconds apart. For one thread. Cost: one system call per axis.
class CounterEncoderBank {
 public:
  /// Configures the counters to count every edge over their whole range; keeps their values. Throws
  /// SysfsError if a counter refuses.
  explicit CounterEncoderBank(const CounterSettings& settings);

  [[nodiscard]] core::EncoderReading read() noexcept;

 private:
  struct Axis {
    FileDescriptor file;
    std::uint64_t range = 0;  ///< number of values of the hardware counter
    std::uint64_t last = 0;
    std::uint32_t count = 0;  ///< value of read(); wraps at 2^32
    bool valid = true;        ///< false after the first failed read
  };
  static void advance(Axis& axis) noexcept;

  std::vector<Axis> axes_;
};

static_assert(EncoderBank<CounterEncoderBank>);

}  // namespace tactree::hal::linux_gpio
