#pragma once
// The parts that all SVG pictures of an evaluation have.

#include <string>

namespace tactree::evaluation {

/// The beginning of a picture of this size (pixels) on white.
[[nodiscard]] std::string begin_svg(double width, double height);

/// `anchor`: start, middle or end. `attributes`: further ones, each after a space.
void add_text(std::string& svg, double x, double y, const char* anchor, const std::string& words,
              const char* attributes = "");

inline constexpr const char* kSvgEnd = "</svg>\n";

}  // namespace tactree::evaluation
