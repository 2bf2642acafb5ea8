#include "tactree/plant/trigonometry.hpp"

#include <cmath>
#include <cstdint>
#include <numbers>

namespace tactree::plant {
namespace {

// Coefficients of the Taylor series about 0 in the square of the angle, highest first. The first
// terms left out are below 1e-19 and 3e-18 within an eighth of a turn.
constexpr double kSine[] = {1.0 / 355'687'428'096'000.0,  // 17!
                            -1.0 / 1'307'674'368'000.0,
                            1.0 / 6'227'020'800.0,
                            -1.0 / 39'916'800.0,
                            1.0 / 362'880.0,
                            -1.0 / 5'040.0,
                            1.0 / 120.0,
                            -1.0 / 6.0};
constexpr double kCosine[] = {1.0 / 20'922'789'888'000.0,  // 16!
                              -1.0 / 87'178'291'200.0,
                              1.0 / 479'001'600.0,
                              -1.0 / 3'628'800.0,
                              1.0 / 40'320.0,
                              -1.0 / 720.0,
                              1.0 / 24.0,
                              -0.5};

double polynomial(const double (&coefficients)[8], double x) {
  double sum = 0.0;
  for (const double coefficient : coefficients) {
    sum = (sum + coefficient) * x;
  }
  return sum;
}

}  // namespace

SineCosine sine_cosine(double angle_rad) {
  const double quarters = std::floor(angle_rad * (2.0 / std::numbers::pi) + 0.5);
  const double x = angle_rad - quarters * (0.5 * std::numbers::pi);
  const double xx = x * x;
  const double s = x + x * polynomial(kSine, xx);
  const double c = 1.0 + polynomial(kCosine, xx);
  const auto quadrant = static_cast<std::int64_t>(quarters) & 3;
  const double sine = (quadrant & 1) != 0 ? c : s;
  const double cosine = (quadrant & 1) != 0 ? s : c;
  return {quadrant >= 2 ? -sine : sine, quadrant == 1 || quadrant == 2 ? -cosine : cosine};
}

}  // namespace tactree::plant
