#pragma once
// Letters of 5 x 7 dots for the scale and caption of a picture, without a font library.

#include <array>
#include <cstdint>

namespace tactree::picture {

inline constexpr int kGlyphRows = 7;
inline constexpr int kGlyphColumns = 5;

/// Rows from the top; bit 4 is the leftmost dot.
using Glyph = std::array<std::uint8_t, kGlyphRows>;

/// Glyph of a letter; an empty box for an unknown letter. Upper-case letters are drawn as
/// lower-case letters.
[[nodiscard]] const Glyph& glyph_of(char letter);

}  // namespace tactree::picture
