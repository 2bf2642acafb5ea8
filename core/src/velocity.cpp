#include "tactree/core/velocity.hpp"

namespace tactree::core {
namespace {

constexpr float kTwoPi = 6.2831853F;

// Two samples can be a whole quantum off the line, and their float32 a little more.
constexpr float kTolerance = 1.1F;

/// Does the line from `from` (age `window`) to `to` (age 0) pass every sample between within the
/// quantum?
struct Axis {
  float history[kVelocityWindow + 1];  // newest first
  std::uint32_t count;                 // valid entries, at least 2

  [[nodiscard]] bool line_fits(std::uint32_t window, float slope, float quantum) const {
    for (std::uint32_t age = 1; age < window; ++age) {  // bound: kVelocityWindow
      const float expected = history[0] - slope * static_cast<float>(age);
      if (!(absolute(history[age] - expected) <= quantum)) {
        return false;
      }
    }
    return true;
  }

  /// Change per sample over the longest window that fits.
  [[nodiscard]] float slope(float quantum) const {
    float best = history[0] - history[1];
    for (std::uint32_t window = 2; window < count; ++window) {  // bound: kVelocityWindow
      const float candidate = (history[0] - history[window]) / static_cast<float>(window);
      if (!line_fits(window, candidate, quantum)) {
        break;
      }
      best = candidate;
    }
    return best;
  }
};

}  // namespace

void VelocityEstimator::configure(float period_s, float quantum_m, float cutoff_hz) {
  period_s_ = period_s;
  quantum_m_ = kTolerance * quantum_m;
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
  samples_[newest_] = position;
  count_ = count_ < kSlots ? count_ + 1U : kSlots;
  if (count_ < 2) {
    return velocity_;
  }
  Axis x{{}, count_};
  Axis y{{}, count_};
  Axis z{{}, count_};
  for (std::uint32_t age = 0; age < count_; ++age) {  // bound: kVelocityWindow + 1
    x.history[age] = past(age).x;
    y.history[age] = past(age).y;
    z.history[age] = past(age).z;
  }
  const Vec3 per_sample = {x.slope(quantum_m_), y.slope(quantum_m_), z.slope(quantum_m_)};
  const Vec3 estimate = (1.0F / period_s_) * per_sample;
  velocity_ += share_ * (estimate - velocity_);
  return velocity_;
}

}  // namespace tactree::core
