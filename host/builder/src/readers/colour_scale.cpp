#include "colour_scale.hpp"

#include <algorithm>
#include <cmath>

namespace tactree::builder {
namespace {

// Computed colours may exceed their range by a little.
constexpr double kMostOfOne = 1.5;
constexpr double kMostOfByte = 255.5;
constexpr double kMostOfWord = 65535.5;
constexpr double kWordPerByte = 257.0;

std::uint8_t to_byte(double value) {
  if (!(value > 0.0)) return 0;  // also NaN
  return value >= 255.0 ? std::uint8_t{255} : static_cast<std::uint8_t>(std::lround(value));
}

}  // namespace

ColourRange colour_range(ScalarType type) {
  if (is_float(type)) return ColourRange::kAuto;
  return size_of(type) == 1 ? ColourRange::kByte : ColourRange::kWordOrByte;
}

void ColourScale::begin(ColourRange range, std::size_t first) {
  range_ = range;
  first_ = first;
  largest_ = range == ColourRange::kAuto ? Largest::kOne : Largest::kByte;
}

ColourScale::Colour ColourScale::to_bytes(const std::array<double, 3>& colour,
                                          std::span<Colour> earlier) {
  const double largest = std::max({colour[0], colour[1], colour[2]});
  if (!std::isfinite(colour[0] + colour[1] + colour[2])) {
    ++missing_;
    return {0, 0, 0};
  }
  if (range_ != ColourRange::kByte) {
    if (largest_ == Largest::kOne && largest > kMostOfOne) leave(earlier);
    if (largest_ == Largest::kByte && largest > kMostOfByte) leave(earlier);
    beyond_ = beyond_ || largest > kMostOfWord;
  }
  double factor = 1.0;
  if (largest_ == Largest::kOne) factor = 255.0;
  if (largest_ == Largest::kWord) factor = 1.0 / kWordPerByte;
  return {to_byte(colour[0] * factor), to_byte(colour[1] * factor), to_byte(colour[2] * factor)};
}

/// Converts the colours of this range so far from their range to the next larger one.
void ColourScale::leave(std::span<Colour> earlier) {
  const bool unit = largest_ == Largest::kOne;
  largest_ = unit ? Largest::kByte : Largest::kWord;
  for (Colour& colour : earlier.subspan(std::min(first_, earlier.size()))) {
    for (std::uint8_t& channel : colour) channel = to_byte(channel / (unit ? 255.0 : kWordPerByte));
  }
}

}  // namespace tactree::builder
