#pragma once
// The watchdog of a Linux computer (/dev/watchdog): resets it when it is not kicked any more. Its
// shortest time is a second as a rule: it ends what nothing else could end, the loop's own guard is
// faster (enable_guard.hpp).

#include <cstdint>
#include <stdexcept>
#include <string>

#include "tactree/hal/linux/file_descriptor.hpp"

namespace tactree::hal {

class WatchdogError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

class WatchdogDevice {
 public:
  /// Starts it. `timeout_s`: 1 or more; the driver may take the next that it can do. Throws
  /// WatchdogError with file, cause and remedy.
  WatchdogDevice(const std::string& file, std::uint32_t timeout_s);
  /// Stops it, where the driver lets it be stopped.
  ~WatchdogDevice();
  WatchdogDevice(WatchdogDevice&&) noexcept = default;
  WatchdogDevice& operator=(WatchdogDevice&&) = delete;

  void kick() noexcept;

 private:
  FileDescriptor file_;
};

/// When to kick: once for each stretch of so many ticks that were all in time.
class InTimeCounter {
 public:
  explicit InTimeCounter(std::uint32_t ticks) : wanted_(ticks) {}
  /// Once a tick. Cost: constant.
  [[nodiscard]] bool is_due(bool in_time) {
    ticks_ = in_time ? ticks_ + 1U : 0U;
    if (ticks_ < wanted_) {
      return false;
    }
    ticks_ = 0;
    return true;
  }

 private:
  std::uint32_t wanted_;
  std::uint32_t ticks_ = 0;
};

}  // namespace tactree::hal
