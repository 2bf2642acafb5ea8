#pragma once
// The speed of a quantised position: the longest of a few windows of past samples whose straight
// line passes the shorter ones within the quantisation, then a low-pass filter. Slow motion gets a
// long window and little noise, fast motion a short one and little delay. (Janabi-Sharifi, Hayward
// and Chen, "Discrete-time adaptive windowing for velocity estimation", IEEE T-CST 8(6), 2000,
// end-fit variant.)

#include <cstdint>

#include "tactree/core/vec3.hpp"

namespace tactree::core {

/// Samples of the longest window, less one.
inline constexpr std::uint32_t kVelocityWindow = 15;
/// Windows that are tried beyond that of two samples.
inline constexpr std::uint32_t kVelocityWindows = 3;

/// Interrupt safe: no shared state.
class VelocityEstimator {
 public:
  /// period_s > 0: between two samples; quantum >= 0: step of each component, m or rad;
  /// cutoff_hz > 0: of the first-order low-pass filter.
  void configure(float period_s, Vec3 quantum, float cutoff_hz);

  /// Forgets the past; the velocity is 0.
  void reset();

  /// Takes the position of this tick and returns the velocity, m/s or rad/s; bounded for finite
  /// positions by the largest difference of two samples over the period.
  /// Cost: kVelocityWindows on each axis, about 15 operations each.
  Vec3 update(Vec3 position);

  [[nodiscard]] Vec3 velocity() const { return velocity_; }

 private:
  static constexpr std::uint32_t kSlots = 16;
  static_assert(kSlots == kVelocityWindow + 1);

  /// Change per sample over the longest window whose line, from its oldest sample to the newest,
  /// passes the end of every shorter one within the quantum.
  [[nodiscard]] float slope(const float (&samples)[kSlots], float quantum) const;

  float samples_[3][kSlots]{};  // rings, one a component
  std::uint32_t newest_ = 0;
  std::uint32_t count_ = 0;
  float period_s_ = 1e-3F;
  Vec3 quantum_{};
  float share_ = 1.0F;  // of a new estimate in the filtered one
  Vec3 velocity_{};
};

}  // namespace tactree::core
