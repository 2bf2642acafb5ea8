#pragma once
// Letters of 5 x 7 dots for the scale and caption of a picture, without a font library.

#include <array>
#include <cstdint>

namespace tactree::picture {

inline constexpr int kGlyphRows = 7;
inline constexpr int kGlyphColumns = 5;

/// Rows from the top; bit 4 is the leftmost dot.
using Glyph = std::array<std::uint8_t, kGlyphRows>;

/// An empty box for a missing letter. Capital letters are drawn as small ones.
[[nodiscard]] const Glyph& glyph_of(char letter);

}  // namespace tactree::picture
