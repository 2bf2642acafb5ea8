#pragma once
// Letters of 5 x 7 dots: what a picture's scale and caption need, without a font library.

#include <array>
#include <cstdint>

namespace tactree::picture {

inline constexpr int kGlyphRows = 7;
inline constexpr int kGlyphColumns = 5;

/// Rows from above; bit 4 is the leftmost dot.
using Glyph = std::array<std::uint8_t, kGlyphRows>;

/// Of a letter that there is none of: an empty box. Capital letters are drawn as small ones.
[[nodiscard]] const Glyph& glyph_of(char letter);

}  // namespace tactree::picture
