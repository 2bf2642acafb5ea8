#pragma once
// A picture of a model from front and back: points as discs shaded by their normals, a scale, and
// marks at the ends of the surface.

#include <array>
#include <cstdint>
#include <span>

#include "tactree/core/model/blob.hpp"
#include "tactree/picture/raster.hpp"

namespace tactree::picture {

/// A hole or an open end of the surface.
struct Mark {
  std::array<float, 3> centre_m{};
  float diameter_m = 0.0F;
  bool is_hole = true;  ///< false: an open end or edge
};

inline constexpr int kPictureWidth = 1280;
inline constexpr int kPictureHeight = 720;

/// `marks`: widest first; the first eight are drawn, with a legend. Marks behind the surface are
/// drawn faintly. doubtful: empty, or per point of the blob: 1 if its side is doubtful; such points
/// get a colour of their own, with a legend. Precondition: !view.empty(). Cost: about 0.1 us per
/// point.
[[nodiscard]] Raster draw_model(const core::BlobView& view, std::span<const Mark> marks,
                                std::span<const std::uint8_t> doubtful = {});

}  // namespace tactree::picture
