#pragma once
// The number of interrupts of a GPIO line, from /sys/kernel/irq.

#include <cstdint>
#include <set>
#include <string>

#include "tactree/hal/linux/file_descriptor.hpp"

namespace tactree::hal::linux_gpio {

/// Returns the interrupts in use by `consumer`, as names of folders in /sys/kernel/irq.
[[nodiscard]] std::set<std::string> interrupts_of(const std::string& consumer);

class InterruptCounter {
 public:
  /// Throws GpioError.
  explicit InterruptCounter(const std::string& interrupt);
  /// Wraps at 2^32. Cost: one system call.
  [[nodiscard]] std::uint32_t read() const noexcept;

 private:
  FileDescriptor file_;
};

}  // namespace tactree::hal::linux_gpio
