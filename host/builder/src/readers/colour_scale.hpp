#pragma once
// Converts the colours of points to bytes. Formats and programs differ in the largest value of a
// colour: 1, 255 or 65535. The largest value of all points decides.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "scalar.hpp"

namespace tactree::builder {

enum class ColourRange : std::uint8_t {
  kNone,
  kByte,        ///< 0 .. 255
  kWordOrByte,  ///< 0 .. 65535 if a value exceeds 255, else 0 .. 255
  kAuto,        ///< as kWordOrByte if a value exceeds 1.5, else 0 .. 1
};

/// Range of the colours that a file holds as numbers of this type.
[[nodiscard]] ColourRange colour_range(ScalarType type);

class ColourScale {
 public:
  using Colour = std::array<std::uint8_t, 3>;

  /// The colours from index `first` on have a range of their own.
  void begin(ColourRange range, std::size_t first);
  [[nodiscard]] ColourRange range() const { return range_; }
  /// Index of the first colour of this range. Set it when colours before it are removed.
  [[nodiscard]] std::size_t first() const { return first_; }
  void set_first(std::size_t first) { first_ = first; }

  /// Converts a colour. Converts those before it, `earlier`, again if it exceeds their range.
  [[nodiscard]] Colour to_bytes(const std::array<double, 3>& colour, std::span<Colour> earlier);

  /// Number of colours that were not a number; they became black.
  [[nodiscard]] std::uint64_t missing() const { return missing_; }
  /// True if a colour exceeds all ranges.
  [[nodiscard]] bool is_beyond() const { return beyond_; }

 private:
  enum class Largest : std::uint8_t { kOne, kByte, kWord };

  void leave(std::span<Colour> earlier);

  ColourRange range_ = ColourRange::kNone;
  Largest largest_ = Largest::kByte;
  std::size_t first_ = 0;
  std::uint64_t missing_ = 0;
  bool beyond_ = false;
};

}  // namespace tactree::builder
