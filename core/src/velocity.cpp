#include "tactree/core/velocity.hpp"

namespace tactree::core {
namespace {

constexpr float kTwoPi = 6.2831853F;

// Two samples can be a whole quantum off the line, and their float32 a little more.
constexpr float kTolerance = 1.1F;

constexpr float kOneOver[kVelocityWindow + 1] = {
    0.0F,     1.0F,     1.0F / 2,  1.0F / 3,  1.0F / 4,  1.0F / 5,  1.0F / 6,  1.0F / 7,
    1.0F / 8, 1.0F / 9, 1.0F / 10, 1.0F / 11, 1.0F / 12, 1.0F / 13, 1.0F / 14, 1.0F / 15};

struct Axis {
  float history[kVelocityWindow + 1];  // newest first
  std::uint32_t count;                 // valid entries, at least 2

  /// Change per sample over the longest window whose line, from its oldest sample to the newest,
  /// passes every sample between within the quantum. Each sample allows the line a range of slopes;
  /// their common part is carried along, so that one pass is enough.
  [[nodiscard]] float slope(float quantum) const {
    float best = history[0] - history[1];
    float lowest = best - quantum;
    float highest = best + quantum;
    for (std::uint32_t window = 2; window < count; ++window) {  // bound: kVelocityWindow
      const float candidate = (history[0] - history[window]) * kOneOver[window];
      if (!(candidate >= lowest && candidate <= highest)) {
        break;
      }
      best = candidate;
      const float play = quantum * kOneOver[window];
      lowest = candidate - play > lowest ? candidate - play : lowest;
      highest = candidate + play < highest ? candidate + play : highest;
    }
    return best;
  }
};

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
  const Vec3 per_sample = {x.slope(quantum_.x), y.slope(quantum_.y), z.slope(quantum_.z)};
  const Vec3 estimate = (1.0F / period_s_) * per_sample;
  velocity_ += share_ * (estimate - velocity_);
  return velocity_;
}

}  // namespace tactree::core
