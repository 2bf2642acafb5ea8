#pragma once
// Encoders at the quadrature counters of a Linux computer (/sys/bus/counter). The hardware counts,
// so no edge is missed, however late the program looks.

#include <cstdint>
#include <string>
#include <vector>

#include "tactree/hal/board.hpp"
#include "tactree/hal/linux/file_descriptor.hpp"
#include "tactree/hal/linux/sysfs_error.hpp"

namespace tactree::hal::linux_gpio {

struct CounterAxis {
  std::string device;       ///< as in "48300180.counter": the numbers of counters change
  std::uint32_t count = 0;  ///< which of that device
};

struct CounterSettings {
  std::string root = "/sys/bus/counter/devices";
  std::vector<CounterAxis> axes;  ///< 1 .. core::kAxes
};

/// The folder of one count. Throws SysfsError: no such counter (and which there are), no such
/// count.
[[nodiscard]] std::string find_count(const std::string& root, const CounterAxis& axis);

/// An EncoderBank; axes that are not named read 0. Counters of fewer than 32 bits are continued
/// beyond their ends: between two reads one must move by less than half its range. No index pulses.
/// Cost: one system call an axis, so that the axes are some microseconds apart.
class CounterEncoderBank {
 public:
  /// Sets the counters to count each edge, over their whole range, from where they are. Throws
  /// SysfsError: one refuses that.
  explicit CounterEncoderBank(const CounterSettings& settings);

  [[nodiscard]] core::EncoderReading read() noexcept;

 private:
  struct Axis {
    FileDescriptor file;
    std::uint64_t range = 0;  ///< of the hardware's count
    std::uint64_t last = 0;
    std::uint32_t count = 0;  ///< what is read: wraps at 2^32
    bool valid = true;        ///< until the first that could not be read
  };
  static void advance(Axis& axis) noexcept;

  std::vector<Axis> axes_;
};

static_assert(EncoderBank<CounterEncoderBank>);

}  // namespace tactree::hal::linux_gpio
