#pragma once
// A second process that holds the enable line as well, and puts it off when the control loop ends
// or hangs, however it ends: a crash, SIGKILL, SIGSTOP, an endless loop. The kernel alone would
// give the line back, and leave it on with some drivers.

#include <sys/types.h>

#include <cstdint>
#include <stdexcept>

#include "tactree/hal/linux/gpio_lines.hpp"

namespace tactree::hal::linux_gpio {

struct GuardSettings {
  std::uint64_t silence_ns = 10'000'000;  ///< longest time without a beat, after the first one
  int priority = 0;                       ///< of SCHED_FIFO; 0: none
};

class EnableGuard {
 public:
  /// Forks: to be made while the program has one thread, before it opens what is not the guard's
  /// business. `enable` must be off and outlive the guard. Throws std::runtime_error.
  EnableGuard(GpioLines& enable, const GuardSettings& settings);
  /// The guard puts the line off, and ends.
  ~EnableGuard();
  EnableGuard(const EnableGuard&) = delete;
  EnableGuard& operator=(const EnableGuard&) = delete;

  /// The loop is alive. At a silence the guard puts the line off and kills this process: it must
  /// not put the line on again. Cost: one store.
  void beat() noexcept;
  /// No beats are wanted any more: the line is off, and stays so.
  void rest() noexcept;
  [[nodiscard]] pid_t process() const { return process_; }

 private:
  struct Shared;
  Shared* shared_ = nullptr;
  pid_t process_ = -1;
};

}  // namespace tactree::hal::linux_gpio
