#include "tactree/picture/raster.hpp"

#include <png.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "letters.hpp"

namespace tactree::picture {
namespace {

Colour mix(Colour below, Colour above, float opacity) {
  const float rest = 1.0F - opacity;
  return {rest * below.red + opacity * above.red, rest * below.green + opacity * above.green,
          rest * below.blue + opacity * above.blue};
}

std::uint8_t to_byte(float share) {
  return static_cast<std::uint8_t>(std::lround(255.0F * std::clamp(share, 0.0F, 1.0F)));
}

/// Pixels from `low` to `high`, clipped to 0 .. `size` - 1.
struct Range {
  Range(float low, float high, int size)
      : first(static_cast<int>(std::floor(std::clamp(low, 0.0F, static_cast<float>(size))))),
        last(static_cast<int>(std::ceil(std::clamp(high, -1.0F, static_cast<float>(size - 1))))) {}
  int first;
  int last;
};

}  // namespace

Raster::Raster(int width, int height, Colour background)
    : width_(width),
      height_(height),
      pixels_(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), background),
      depths_(pixels_.size(), std::numeric_limits<float>::infinity()) {}

void Raster::disc(float x, float y, float radius, float depth, Colour colour) {
  const Range rows(y - radius, y + radius, height_);
  const Range columns(x - radius, x + radius, width_);
  for (int row = rows.first; row <= rows.last; ++row) {
    for (int column = columns.first; column <= columns.last; ++column) {
      const float right = static_cast<float>(column) - x;
      const float down = static_cast<float>(row) - y;
      const std::size_t at = index(column, row);
      if (right * right + down * down <= radius * radius && depth < depths_[at]) {
        depths_[at] = depth;
        pixels_[at] = colour;
      }
    }
  }
}

void Raster::circle(float x, float y, float radius, float width, Colour colour, float opacity) {
  const float outer = radius + 0.5F * width;
  const Range rows(y - outer, y + outer, height_);
  const Range columns(x - outer, x + outer, width_);
  for (int row = rows.first; row <= rows.last; ++row) {
    for (int column = columns.first; column <= columns.last; ++column) {
      const float distance =
          std::hypot(static_cast<float>(column) - x, static_cast<float>(row) - y);
      if (std::abs(distance - radius) <= 0.5F * width) {
        Colour& pixel = pixels_[index(column, row)];
        pixel = mix(pixel, colour, opacity);
      }
    }
  }
}

void Raster::line(float x1, float y1, float x2, float y2, float width, Colour colour,
                  float opacity) {
  const float length = std::max(std::hypot(x2 - x1, y2 - y1), 1e-3F);
  const float right = (x2 - x1) / length;
  const float down = (y2 - y1) / length;
  const Range rows(std::min(y1, y2) - width, std::max(y1, y2) + width, height_);
  const Range columns(std::min(x1, x2) - width, std::max(x1, x2) + width, width_);
  for (int row = rows.first; row <= rows.last; ++row) {
    for (int column = columns.first; column <= columns.last; ++column) {
      const float x = static_cast<float>(column) - x1;
      const float y = static_cast<float>(row) - y1;
      const float along = right * x + down * y;
      if (along >= 0.0F && along <= length && std::abs(right * y - down * x) <= 0.5F * width) {
        Colour& pixel = pixels_[index(column, row)];
        pixel = mix(pixel, colour, opacity);
      }
    }
  }
}

void Raster::box(int left, int top, int right, int bottom, Colour colour) {
  for (int y = std::max(top, 0); y < std::min(bottom, height_); ++y) {
    for (int x = std::max(left, 0); x < std::min(right, width_); ++x) {
      pixels_[index(x, y)] = colour;
    }
  }
}

int Raster::text(int x, int y, std::string_view line, int dot, Colour colour) {
  const int begin = x;
  for (const char letter : line) {
    const Glyph& glyph = glyph_of(letter);
    for (int row = 0; row < kGlyphRows; ++row) {
      for (int column = 0; column < kGlyphColumns; ++column) {
        if ((glyph[static_cast<std::size_t>(row)] >> (kGlyphColumns - 1 - column) & 1) != 0) {
          const int left = x + column * dot;
          const int top = y + row * dot;
          box(left, top, left + dot, top + dot, colour);
        }
      }
    }
    x += (kGlyphColumns + 1) * dot;
  }
  return x - begin;
}

Raster Raster::halved() const {
  Raster half(width_ / 2, height_ / 2, {});
  for (int y = 0; y < half.height_; ++y) {
    for (int x = 0; x < half.width_; ++x) {
      const Colour top = mix(pixel(2 * x, 2 * y), pixel(2 * x + 1, 2 * y), 0.5F);
      const Colour bottom = mix(pixel(2 * x, 2 * y + 1), pixel(2 * x + 1, 2 * y + 1), 0.5F);
      half.pixels_[half.index(x, y)] = mix(top, bottom, 0.5F);
      half.depths_[half.index(x, y)] = depth(2 * x, 2 * y);
    }
  }
  return half;
}

std::vector<std::byte> Raster::png() const {
  std::vector<std::uint8_t> rgb;
  rgb.reserve(3 * pixels_.size());
  for (const Colour& colour : pixels_) {
    rgb.insert(rgb.end(), {to_byte(colour.red), to_byte(colour.green), to_byte(colour.blue)});
  }
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(width_);
  image.height = static_cast<png_uint_32>(height_);
  image.format = PNG_FORMAT_RGB;
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(image);
  std::vector<std::byte> file(size);
  if (png_image_write_to_memory(&image, file.data(), &size, 0, rgb.data(), 0, nullptr) == 0) {
    throw std::runtime_error(std::string("PNG: ") + image.message);
  }
  file.resize(size);
  return file;
}

}  // namespace tactree::picture
