#pragma once
// Implements wait() of a board's ticker with the tick timer.
// Loop and memory annotations: docs/BOUND.md.

#include <cstdint>

#include "platform.hpp"

namespace tactree::firmware {

class DeadlineWait {
 public:
  /// Blocks until the next deadline, which has already passed if wait() is called from the tick
  /// interrupt. Returns the number of deadlines missed since the last call.
  [[nodiscard]] std::uint32_t wait() {
    while (deadlines() == seen_) {  // bound: 0 (a deadline has begun this tick)
      wait_for_interrupt();
    }
    const std::uint32_t now = deadlines();
    const std::uint32_t missed = now - seen_ - 1U;
    seen_ = now;
    return missed;
  }

 private:
  std::uint32_t seen_ = 0;
};

}  // namespace tactree::firmware
