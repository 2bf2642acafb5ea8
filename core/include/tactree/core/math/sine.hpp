#pragma once
// Sine and cosine without libm, bit-identical with every compiler and core.
//
// Interrupt safety: pure functions.

#include <cstdint>

namespace tactree::core {

struct SineCosine {
  float sine = 0.0F;
  float cosine = 1.0F;
};

/// Maximum angle for which the error is specified, rad. The kinematics needs 400: the sum of two
/// joints, each within 100 (DeviceModel) and a joint_margin of at most 100 beyond.
inline constexpr float kMaxAngle = 1000.0F;

/// Sine and cosine of `angle` (rad). Error: below 1.2e-7 for |angle| <= 2 pi, below 2e-7 up to
/// kMaxAngle. Beyond kMaxAngle and for NaN the sine is 0 and the cosine 1.
/// Taylor series of degree 9 and 8 about the nearest multiple of pi / 2. Cost: about 30 operations.
[[nodiscard]] inline SineCosine sine_cosine(float angle) {
  if (!(angle >= -kMaxAngle && angle <= kMaxAngle)) {
    return {};
  }
  // Cody-Waite reduction: pi / 2 is the sum of three parts. The first two have so few bits that
  // their products with q are exact.
  constexpr float kPerQuarter = 0.63661977F;
  constexpr float kQuarterHigh = 1.5703125F;
  constexpr float kQuarterMiddle = 0.0004837512969970703F;
  constexpr float kQuarterLow = 7.549790126404332e-08F;
  const float rough = angle * kPerQuarter;
  const auto quarters = static_cast<std::int32_t>(rough < 0.0F ? rough - 0.5F : rough + 0.5F);
  const auto q = static_cast<float>(quarters);
  const float x = ((angle - q * kQuarterHigh) - q * kQuarterMiddle) - q * kQuarterLow;
  const float xx = x * x;
  const float s =
      x + x * xx * (-1.0F / 6.0F + xx * (1.0F / 120.0F + xx * (-1.0F / 5040.0F + xx / 362880.0F)));
  const float c = 1.0F + xx * (-0.5F + xx * (1.0F / 24.0F + xx * (-1.0F / 720.0F + xx / 40320.0F)));
  const bool swapped = (quarters & 1) != 0;
  const float sine = swapped ? c : s;
  const float cosine = swapped ? s : c;
  return {(quarters & 2) != 0 ? -sine : sine, ((quarters + 1) & 2) != 0 ? -cosine : cosine};
}

}  // namespace tactree::core
