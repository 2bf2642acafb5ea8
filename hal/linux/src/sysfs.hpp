#pragma once
// Devices that Linux shows as folders with one value in each file.

#include <cstdint>
#include <string>

#include "tactree/hal/linux/file_descriptor.hpp"

namespace tactree::hal::linux_gpio {

/// The entry of `root` (/sys/class/pwm, /sys/bus/counter/devices ...) that belongs to the device
/// `name`, as in "48300180.counter": the entries' own numbers change. `kind` is for messages:
/// "PWM chip". Throws SysfsError: there is none, and which there are.
[[nodiscard]] std::string find_sysfs_device(const std::string& root, const std::string& name,
                                            const std::string& kind);

/// "PWM chip 'name'"
[[nodiscard]] std::string quoted(const std::string& kind, const std::string& name);

/// Waits a moment for a file that is being made, or whose owner is being changed. Throws
/// SysfsError.
[[nodiscard]] FileDescriptor open_value(const std::string& file, int flags);

/// One write is one value. False: the kernel did not take it.
[[nodiscard]] bool write_value(int file, std::int64_t value) noexcept;
[[nodiscard]] bool read_value(int file, std::int64_t& value) noexcept;

/// Throws SysfsError with `remedy`.
void set_value(const std::string& file, std::int64_t value, const std::string& remedy);

}  // namespace tactree::hal::linux_gpio
