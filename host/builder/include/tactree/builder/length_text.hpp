#pragma once
// Lengths in messages to the user.

#include <Eigen/Core>
#include <string>

namespace tactree::builder {

struct LengthUnit {
  const char* name;
  double per_metre;
};
/// The unit that fits a length: um below 0.1 mm, mm, m from 1 m, km from 10 km.
[[nodiscard]] LengthUnit length_unit(double metres);

/// Formats a number without an exponent, with at least `digits` significant digits, at most nine
/// decimals and no trailing zeros.
[[nodiscard]] std::string number_text(double value, int digits);

/// Formats a length in the unit that fits it: "3.114 mm".
[[nodiscard]] std::string length_text(double metres, int digits = 4);

/// Formats three lengths in the unit that fits the largest: "238.5 x 494.2 x 20 m".
[[nodiscard]] std::string size_text(const Eigen::Vector3d& metres);

/// Formats a position in the unit that fits its largest coordinate: "(12, -3.5, 0) mm".
[[nodiscard]] std::string place_text(const Eigen::Vector3d& metres);

}  // namespace tactree::builder
