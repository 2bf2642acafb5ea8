#pragma once
// What a model looks like: its points as discs shaded by their normals, from in front and from
// behind, with a scale, and marks where the surface ends.

#include <array>
#include <span>

#include "tactree/core/blob.hpp"
#include "tactree/picture/raster.hpp"

namespace tactree::picture {

/// A place where the surface ends.
struct Mark {
  std::array<float, 3> centre_m{};
  float diameter_m = 0.0F;
  bool is_hole = true;  ///< false: an open end or edge
};

inline constexpr int kPictureWidth = 1280;
inline constexpr int kPictureHeight = 720;

/// Marks that lie behind the surface are drawn faintly. Precondition: !view.empty().
/// Cost: about 0.1 us a point.
[[nodiscard]] Raster draw_model(const core::BlobView& view, std::span<const Mark> marks);

}  // namespace tactree::picture
