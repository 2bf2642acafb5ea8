#include "tactree/builder/length_text.hpp"

#include <fmt/core.h>

#include <cmath>

namespace tactree::builder {

std::string length_text(double metres) {
  const double size = std::abs(metres);
  if (size >= 9999.5) {
    return fmt::format("{:.4g} km", 1e-3 * metres);
  }
  if (size >= 0.99995) {
    return fmt::format("{:.4g} m", metres);
  }
  return size >= 1e-4 || size == 0.0 ? fmt::format("{:.4g} mm", 1e3 * metres)
                                     : fmt::format("{:.4g} um", 1e6 * metres);
}

}  // namespace tactree::builder
