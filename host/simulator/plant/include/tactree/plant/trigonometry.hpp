#pragma once
// Sine and cosine of the simulated mechanics, from sums and products only: the same bits on every
// computer, in contrast to libm.

namespace tactree::plant {

struct SineCosine {
  double sine = 0.0;
  double cosine = 1.0;
};

/// Within 1e-12 for |angle_rad| <= 1000.
[[nodiscard]] SineCosine sine_cosine(double angle_rad);

}  // namespace tactree::plant
