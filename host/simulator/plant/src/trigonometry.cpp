#include "tactree/plant/trigonometry.hpp"

#include <cmath>
#include <cstdint>
#include <numbers>

namespace tactree::plant {

SineCosine sine_cosine(double angle_rad) {
  const double quarters = std::floor(angle_rad * (2.0 / std::numbers::pi) + 0.5);
  const double x = angle_rad - quarters * (0.5 * std::numbers::pi);
  const double xx = x * x;
  // Taylor series about 0, last terms first. x is within an eighth of a turn, where the last term
  // of the sine, x^21 / 21!, is below 1e-21.
  double s = 1.0;
  double c = 1.0;
  for (double n = 20.0; n >= 2.0; n -= 2.0) {
    s = 1.0 - xx / (n * (n + 1.0)) * s;
    c = 1.0 - xx / (n * (n - 1.0)) * c;
  }
  s *= x;
  const auto quadrant = static_cast<std::int64_t>(quarters) & 3;
  const double sine = (quadrant & 1) != 0 ? c : s;
  const double cosine = (quadrant & 1) != 0 ? s : c;
  return {quadrant >= 2 ? -sine : sine, quadrant == 1 || quadrant == 2 ? -cosine : cosine};
}

}  // namespace tactree::plant
