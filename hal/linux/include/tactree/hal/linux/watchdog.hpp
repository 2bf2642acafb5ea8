#pragma once
// The watchdog of a Linux computer (/dev/watchdog): resets the computer if it is not kicked in
// time. Its minimum timeout is usually 1 s; EnableGuard (enable_guard.hpp) reacts faster. The
// watchdog covers a hanging kernel.

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
  /// Starts the watchdog. `timeout_s` >= 1; the driver may round it. Throws WatchdogError with
  /// file, cause and hint.
  WatchdogDevice(const std::string& file, std::uint32_t timeout_s);
  /// Stops the watchdog if the driver allows it.
  ~WatchdogDevice();
  WatchdogDevice(WatchdogDevice&&) noexcept = default;
  WatchdogDevice& operator=(WatchdogDevice&&) = delete;

  /// Restarts the timeout. Cost: one system call.
  void kick() noexcept;

 private:
  FileDescriptor file_;
};

/// Decides when to kick the watchdog: after every `ticks` consecutive ticks on time.
class InTimeCounter {
 public:
  explicit InTimeCounter(std::uint32_t ticks) : wanted_(ticks) {}
  /// Call once per tick. Returns true when the watchdog should be kicked. Cost: constant.
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
