#pragma once
// Devices in sysfs: folders with one value per file.

#include <cstdint>
#include <string>

#include "tactree/hal/linux/file_descriptor.hpp"

namespace tactree::hal::linux_gpio {

/// Finds the entry in `root` (/sys/class/pwm, /sys/bus/counter/devices ...) of the device `name`,
/// e.g. "48300180.counter", because the numbers of the entries vary. `kind` is used in messages,
/// e.g. "PWM chip". Throws SysfsError, which lists the available devices.
[[nodiscard]] std::string find_sysfs_device(const std::string& root, const std::string& name,
                                            const std::string& kind);

/// Returns "PWM chip 'name'".
[[nodiscard]] std::string quoted(const std::string& kind, const std::string& name);

/// Opens a file; waits up to 1 s until it exists and udev has set its group. Throws SysfsError.
[[nodiscard]] FileDescriptor open_value(const std::string& file, int flags);

/// Writes one value in one system call. Returns false if the kernel refuses it.
[[nodiscard]] bool write_value(int file, std::int64_t value) noexcept;
[[nodiscard]] bool read_value(int file, std::int64_t& value) noexcept;

/// Opens the file, writes the value and closes the file. Throws SysfsError with `remedy`.
void set_value(const std::string& file, std::int64_t value, const std::string& remedy);

}  // namespace tactree::hal::linux_gpio
