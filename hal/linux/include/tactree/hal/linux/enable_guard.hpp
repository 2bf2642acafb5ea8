#pragma once
// A second process that holds the enable line and switches it off when the control loop ends or
// hangs: crash, SIGKILL, SIGSTOP, endless loop. The kernel alone only releases the line, and some
// drivers then keep its level.

#include <sys/types.h>

#include <cstdint>

#include "tactree/hal/linux/gpio_lines.hpp"

namespace tactree::hal::linux_gpio {

struct GuardSettings {
  std::uint64_t silence_ns = 10'000'000;  ///< maximum time between two beats
  int priority = 0;                       ///< SCHED_FIFO priority; 0: normal scheduling
};

/// beat() must be called from the thread of the loop.
class EnableGuard {
 public:
  /// Forks. Preconditions: the program has one thread and no other open files; `enable` is off and
  /// outlives the guard. Throws std::runtime_error.
  EnableGuard(GpioLines& enable, const GuardSettings& settings);
  /// Ends the guard process, which switches the line off.
  ~EnableGuard();
  EnableGuard(const EnableGuard&) = delete;
  EnableGuard& operator=(const EnableGuard&) = delete;

  /// Call once per tick; the first call starts the supervision. After `silence_ns` without a call,
  /// the guard switches the line off and kills this process, which could switch it on again. Cost:
  /// one store.
  void beat() noexcept;
  /// Ends the supervision. Precondition: the line is off and stays off.
  void rest() noexcept;
  [[nodiscard]] pid_t process() const { return process_; }

 private:
  struct Shared;
  Shared* shared_ = nullptr;
  pid_t process_ = -1;
};

}  // namespace tactree::hal::linux_gpio
