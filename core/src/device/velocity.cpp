// Adaptive windowing of position samples and a low-pass filter.
// Loop and memory annotations: docs/BOUND.md.
// memory: RAM

#include "tactree/core/device/velocity.hpp"

#include "tactree/core/math/angle.hpp"

namespace tactree::core {
namespace {

// The difference of two samples deviates by up to one quantum; the excess covers float32 rounding.
constexpr float kTolerance = 1.1F;

// The windows, in sample periods; each is at least twice as long as the one before. A hand moves
// little between their ends, so a line that passes the ends also passes the samples between them.
struct Window {
  std::uint32_t samples;
  float inverse;
};
constexpr Window kWindows[kVelocityWindows] = {{3, 1.0F / 3}, {7, 1.0F / 7}, {15, 1.0F / 15}};

}  // namespace

void VelocityEstimator::configure(float period_s, Vec3 quantum, float cutoff_hz) {
  period_s_ = period_s;
  quantum_ = kTolerance * quantum;
  const float turn = kTwoPi * cutoff_hz * period_s;
  share_ = turn / (1.0F + turn);
  reset();
}

void VelocityEstimator::reset() {
  count_ = 0;
  velocity_ = {};
}

Vec3 VelocityEstimator::update(Vec3 position) {
  newest_ = (newest_ + 1U) & (kSlots - 1U);
  samples_[0][newest_] = position.x;
  samples_[1][newest_] = position.y;
  samples_[2][newest_] = position.z;
  count_ = count_ < kSlots ? count_ + 1U : kSlots;
  if (count_ < 2) {
    return velocity_;
  }
  const Vec3 per_sample = {slope(samples_[0], quantum_.x), slope(samples_[1], quantum_.y),
                           slope(samples_[2], quantum_.z)};
  const Vec3 estimate = (1.0F / period_s_) * per_sample;
  velocity_ += share_ * (estimate - velocity_);
  return velocity_;
}

// The end of each window allows a range of slopes. The loop keeps the intersection of the ranges,
// so that one pass is sufficient.
[[gnu::always_inline]] inline float VelocityEstimator::slope(const float (&samples)[kSlots],
                                                             float quantum) const {
  const float newest = samples[newest_];
  float best = newest - samples[(newest_ - 1U) & (kSlots - 1U)];
  float lowest = best - quantum;
  float highest = best + quantum;
  for (const Window& window : kWindows) {  // bound: kVelocityWindows
    if (window.samples >= count_) {
      break;
    }
    const float past = samples[(newest_ - window.samples) & (kSlots - 1U)];
    const float candidate = (newest - past) * window.inverse;
    if (!(candidate >= lowest && candidate <= highest)) {
      break;
    }
    best = candidate;
    const float play = quantum * window.inverse;
    lowest = candidate - play > lowest ? candidate - play : lowest;
    highest = candidate + play < highest ? candidate + play : highest;
  }
  return best;
}

}  // namespace tactree::core
