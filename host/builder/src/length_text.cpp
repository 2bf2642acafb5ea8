#include "tactree/builder/length_text.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace tactree::builder {

LengthUnit length_unit(double metres) {
  const double size = std::abs(metres);
  if (size >= 9999.5) {
    return {"km", 1e-3};
  }
  if (size >= 0.99995) {
    return {"m", 1.0};
  }
  return size >= 1e-4 || !(size > 0.0) ? LengthUnit{"mm", 1e3} : LengthUnit{"um", 1e6};
}

std::string number_text(double value, int digits) {
  if (!std::isfinite(value)) {
    return fmt::format("{}", value);
  }
  const double size = std::abs(value);
  const int leading = size > 0.0 ? static_cast<int>(std::floor(std::log10(size))) : 0;
  std::string text = fmt::format("{:.{}f}", value, std::clamp(digits - 1 - leading, 0, 9));
  if (text.find('.') != std::string::npos) {
    text.erase(text.find_last_not_of('0') + 1);
    if (text.back() == '.') {
      text.pop_back();
    }
  }
  return text == "-0" ? "0" : text;
}

std::string length_text(double metres, int digits) {
  const LengthUnit unit = length_unit(metres);
  const double value = unit.per_metre * metres;
  const bool absurd = value != 0.0 && !(std::abs(value) >= 1e-6 && std::abs(value) < 1e12);
  return (absurd ? fmt::format("{:.{}g}", value, digits) : number_text(value, digits)) + " " +
         unit.name;
}

std::string size_text(const Eigen::Vector3d& metres) {
  const LengthUnit unit = length_unit(metres.cwiseAbs().maxCoeff());
  const Eigen::Vector3d size = unit.per_metre * metres;
  return fmt::format("{} x {} x {} {}", number_text(size.x(), 4), number_text(size.y(), 4),
                     number_text(size.z(), 4), unit.name);
}

std::string place_text(const Eigen::Vector3d& metres) {
  const LengthUnit unit = length_unit(metres.cwiseAbs().maxCoeff());
  const Eigen::Vector3d at = unit.per_metre * metres;
  return fmt::format("({}, {}, {}) {}", number_text(at.x(), 4), number_text(at.y(), 4),
                     number_text(at.z(), 4), unit.name);
}

}  // namespace tactree::builder
