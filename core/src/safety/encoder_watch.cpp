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
    if (still_[i] <= ticks_ / kSettling) {
      lowest_[i] = share[i];
      highest_[i] = share[i];
      continue;
    }
    lowest_[i] = share[i] < lowest_[i] ? share[i] : lowest_[i];
    highest_[i] = share[i] > highest_[i] ? share[i] : highest_[i];
    fine = fine && !(still_[i] >= ticks_ && highest_[i] - lowest_[i] > kChange);
  }
  following_ = true;
  return fine;
}

}  // namespace tactree::core
