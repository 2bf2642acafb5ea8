#pragma once
// Waiting for the tick timer, as a board's ticker does it.

#include <cstdint>

#include "platform.hpp"

namespace tactree::firmware {

class DeadlineWait {
 public:
  /// Returns at the next deadline; at once when one has gone by, which is so in every tick. How
  /// many went by besides it.
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
