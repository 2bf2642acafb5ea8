#include "cleaning/turn.hpp"

#include <cmath>

namespace tactree::builder {
namespace {

constexpr double kRadiansPerDegree = 3.14159265358979323846 / 180.0;

}  // namespace

Eigen::Matrix3d turn_up(UpAxis up) {
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  if (up == UpAxis::kY) {
    turn << 0, 0, 1, 1, 0, 0, 0, 1, 0;  // y -> z, z -> x, x -> y
  } else if (up == UpAxis::kX) {
    turn << 0, 1, 0, 0, 0, 1, 1, 0, 0;  // x -> z, y -> x, z -> y
  }
  return turn;
}

// The cosine of a rounded quarter of a turn is not exactly 0: whole quarters are applied apart.
Eigen::Matrix3d turn_about_z(double degrees) {
  const double rest = std::remainder(degrees, 90.0);
  const double cosine = std::cos(rest * kRadiansPerDegree);
  const double sine = std::sin(rest * kRadiansPerDegree);
  Eigen::Matrix3d turn;
  turn << cosine, -sine, 0, sine, cosine, 0, 0, 0, 1;
  Eigen::Matrix3d quarter;
  quarter << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  const auto quarters = static_cast<int>(std::lround((degrees - rest) / 90.0) % 4);
  for (int i = 0; i < (quarters + 4) % 4; ++i) {
    turn = quarter * turn;
  }
  return turn;
}

}  // namespace tactree::builder
