#pragma once
// Lengths in the messages for a user.

#include <Eigen/Core>
#include <string>

namespace tactree::builder {

struct LengthUnit {
  const char* name;
  double per_metre;
};
/// The unit that fits a length: um below 0.1 mm, mm, m from 1 m, km from 10 km.
[[nodiscard]] LengthUnit length_unit(double metres);

/// Decimal, never with an exponent: at least `digits` significant digits, at most nine decimals,
/// without zeros at the end.
[[nodiscard]] std::string number_text(double value, int digits);

/// "3.114 mm": in the unit that fits.
[[nodiscard]] std::string length_text(double metres, int digits = 4);

/// "238.5 x 494.2 x 20 m": all in the unit that fits the largest.
[[nodiscard]] std::string size_text(const Eigen::Vector3d& metres);

/// "(12, -3.5, 0) mm": all in the unit that fits the largest.
[[nodiscard]] std::string place_text(const Eigen::Vector3d& metres);

}  // namespace tactree::builder
