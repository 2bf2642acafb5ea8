#pragma once
// Sine and cosine of the simulated mechanics. Only sums and products, so that a simulation gives
// the same bits wherever it runs: the functions of libm differ from one to the next.

namespace tactree::plant {

struct SineCosine {
  double sine = 0.0;
  double cosine = 1.0;
};

/// Within 1e-12 for |angle_rad| <= 1000.
[[nodiscard]] SineCosine sine_cosine(double angle_rad);

}  // namespace tactree::plant
