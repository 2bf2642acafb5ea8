// Loop and memory annotations: docs/BOUND.md.
// memory: RAM

#include "tactree/core/safety/encoder_watch.hpp"

namespace tactree::core {

void EncoderWatch::reset() { following_ = false; }

bool EncoderWatch::update(const std::int32_t (&counts)[kAxes], const float (&share)[kAxes],
                          std::uint32_t axes) {
  bool fine = true;
  for (std::uint32_t i = 0; i < axes; ++i) {  // bound: kAxes
    const bool moved = !following_ || counts[i] != count_[i];
    still_[i] = moved ? 0U : still_[i] + (still_[i] < ticks_ ? 1U : 0U);
    count_[i] = counts[i];
    const std::uint32_t settling = ticks_ / kSettling;
    if (still_[i] <= settling) {
      lowest_[i] = share[i];
      highest_[i] = share[i];
      pushed_[i] = 0;
      continue;
    }
    lowest_[i] = share[i] < lowest_[i] ? share[i] : lowest_[i];
    highest_[i] = share[i] > highest_[i] ? share[i] : highest_[i];
    const bool is_pushed = highest_[i] - lowest_[i] > kChange;
    pushed_[i] += is_pushed && pushed_[i] <= settling ? 1U : 0U;
    fine = fine && !(still_[i] >= ticks_ && pushed_[i] > settling);
  }
  following_ = true;
  return fine;
}

}  // namespace tactree::core
