#pragma once
// Errors of devices in /sys.

#include <stdexcept>

namespace tactree::hal::linux_gpio {

/// Message: "PWM chip '48300200.pwm': cause (hint: ...)"
class SysfsError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace tactree::hal::linux_gpio
