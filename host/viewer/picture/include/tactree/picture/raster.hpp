#pragma once
// A picture in memory, drawn without a display or GPU and encoded as PNG.

#include <cstddef>
#include <string_view>
#include <vector>

namespace tactree::picture {

struct Colour {
  float red = 0.0F;  ///< 0 .. 1
  float green = 0.0F;
  float blue = 0.0F;
};

/// x to the right, y down, in pixels. Drawing is clipped to the picture.
class Raster {
 public:
  Raster(int width, int height, Colour background);

  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }
  [[nodiscard]] Colour pixel(int x, int y) const { return pixels_[index(x, y)]; }
  /// Depth of the nearest disc; infinite for the background.
  [[nodiscard]] float depth(int x, int y) const { return depths_[index(x, y)]; }

  /// Draws a disc where no nearer disc was drawn; smaller depths are nearer.
  void disc(float x, float y, float radius, float depth, Colour colour);
  /// Draws on top of all discs; `opacity` 0 .. 1.
  void circle(float x, float y, float radius, float width, Colour colour, float opacity = 1.0F);
  /// A line of the given width, on top of all discs.
  void line(float x1, float y1, float x2, float y2, float width, Colour colour,
            float opacity = 1.0F);
  void box(int left, int top, int right, int bottom, Colour colour);
  /// Draws text in letters of 5 x 7 dots, each `dot` pixels wide: lower-case letters, N (of
  /// newton), digits and ( ) , - . / : _. Returns the width.
  int text(int x, int y, std::string_view line, int dot, Colour colour);

  /// The picture at half the size: each pixel is the mean of four.
  [[nodiscard]] Raster halved() const;

  /// Throws std::runtime_error if libpng fails.
  [[nodiscard]] std::vector<std::byte> png() const;

 private:
  [[nodiscard]] std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
           static_cast<std::size_t>(x);
  }

  int width_;
  int height_;
  std::vector<Colour> pixels_;
  std::vector<float> depths_;
};

}  // namespace tactree::picture
