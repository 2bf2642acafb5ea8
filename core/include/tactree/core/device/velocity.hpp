#pragma once
// Velocity of a quantised position. The estimate is the slope over the longest of a few windows of
// past samples whose straight line passes the ends of the shorter windows within the quantum. A
// low-pass filter follows. Slow motion uses a long window (low noise), fast motion a short one (low
// delay). Source: Janabi-Sharifi, Hayward and Chen, "Discrete-time adaptive windowing for velocity
// estimation", IEEE T-CST 8(6), 2000, end-fit variant.
//
// Interrupt safety: no shared state; one context owns an estimator.

#include <cstdint>

#include "tactree/core/math/vec3.hpp"

namespace tactree::core {

/// Length of the longest window, sample periods. A count of 20 um in it is 1.3 mm/s at 1 kHz, in
/// the window of two samples 20 mm/s. A longer window delays the velocity of a slow motion by more
/// than the present 7.5 ms, half of its length.
inline constexpr std::uint32_t kVelocityWindow = 15;
/// Number of windows, not counting the one of two samples. Each costs about 15 operations per axis.
inline constexpr std::uint32_t kVelocityWindows = 3;

class VelocityEstimator {
 public:
  /// period_s > 0: sample period; quantum >= 0: quantisation step of each component, m or rad;
  /// cutoff_hz > 0: cut-off of the first-order low-pass filter. Calls reset().
  void configure(float period_s, Vec3 quantum, float cutoff_hz);

  /// Clears all samples; the velocity is 0.
  void reset();

  /// Adds the position of this tick (m or rad) and returns the velocity, m/s or rad/s. For finite
  /// positions its absolute value is at most the maximum difference of two samples divided by the
  /// period.
  /// Cost: kVelocityWindows per axis, about 15 operations each.
  Vec3 update(Vec3 position);

  [[nodiscard]] Vec3 velocity() const { return velocity_; }

 private:
  static constexpr std::uint32_t kSlots = 16;
  static_assert(kSlots == kVelocityWindow + 1);

  /// Change per sample over the longest valid window.
  [[nodiscard]] float slope(const float (&samples)[kSlots], float quantum) const;

  float samples_[3][kSlots]{};  // a ring buffer per component
  std::uint32_t newest_ = 0;
  std::uint32_t count_ = 0;
  float period_s_ = 1e-3F;
  Vec3 quantum_{};
  float share_ = 1.0F;  // weight of a new estimate in the low-pass filter
  Vec3 velocity_{};
};

}  // namespace tactree::core
