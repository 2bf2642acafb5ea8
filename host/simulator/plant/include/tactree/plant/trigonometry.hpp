#pragma once
// Sine and cosine for the simulated mechanics. They use basic arithmetic only, therefore their
// results are bit-identical on every computer, in contrast to those of libm.

namespace tactree::plant {

struct SineCosine {
  double sine = 0.0;
  double cosine = 1.0;
};

/// The error is at most 4e-16 for |angle_rad| <= pi, and 1e-12 for |angle_rad| <= 1000.
[[nodiscard]] SineCosine sine_cosine(double angle_rad);

}  // namespace tactree::plant
