#pragma once
// Picture of a model from front and back, with the points as discs shaded by their normals, a
// scale, and marks at holes and open boundaries of the surface. The front of a surface that faces
// one side as a whole, such as a relief, is its outside; of others it is +x. If both sides of the
// surface are seen, a legend names their colours.

#include <array>
#include <cstdint>
#include <span>
#include <string>

#include "tactree/core/model/blob.hpp"
#include "tactree/picture/raster.hpp"

namespace tactree::picture {

/// A hole or an open boundary of the surface.
struct Mark {
  std::array<float, 3> centre_m{};
  float diameter_m = 0.0F;
  bool is_hole = true;  ///< false: an open boundary
};

/// A material in the picture.
struct MaterialKey {
  Colour colour{};
  std::string name;
};
/// Distinct from the colours of its neighbours in the list.
[[nodiscard]] Colour false_colour(std::size_t material);

inline constexpr int kPictureWidth = 1280;
inline constexpr int kPictureHeight = 720;

/// `marks` are in descending order of diameter; the first eight are drawn, with a legend: a number
/// beside the model, and a thin line from it to the place. A mark that the surface hides is drawn
/// in the other view only, or faintly in both if it is hidden in both. The legend lies above the
/// model and names only what occurs. `doubtful` is empty, or has one element per point of the blob:
/// 1 if its orientation is ambiguous. Such points have a separate colour, with a legend.
/// `materials` is empty, or has one element per material of the blob: the outside of their points
/// is drawn in these colours, and a legend names the first eight. `colours` is empty, or has one
/// element (R, G, B) per point of the blob: without `materials`, the outside is drawn in these
/// colours. Precondition: !view.empty(). Cost: about 0.1 us per point.
[[nodiscard]] Raster draw_model(const core::BlobView& view, std::span<const Mark> marks,
                                std::span<const std::uint8_t> doubtful = {},
                                std::span<const MaterialKey> materials = {},
                                std::span<const std::array<std::uint8_t, 3>> colours = {});

}  // namespace tactree::picture
