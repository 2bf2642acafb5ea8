#pragma once
// Materials of a model, and the assignment of the points of a coloured scan to them.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "tactree/core/model/blob_format.hpp"

namespace tactree::builder {

using Colour = std::array<std::uint8_t, 3>;  ///< R, G, B

/// Of the points of a scan without colours where another scan has some.
inline constexpr Colour kNoColour = {212, 196, 176};

/// A colour of a scan, and the number of points that have it or a similar one.
struct ColourCount {
  Colour colour{};
  std::uint64_t points = 0;
};

/// Points of a scan for the colour of a material.
struct ColourMatch {
  std::uint64_t points = 0;       ///< that have the material
  Colour nearest{};               ///< colour of a point
  double squared_distance = 1e6;  ///< of `nearest`, in R, G, B
};

struct ColourMaterial {
  std::string name;
  Colour colour{};
  double tolerance = 0.0;  ///< maximum distance of a matching colour, in R, G, B
  core::BlobMaterial material{};
};

struct MaterialMap {
  core::BlobMaterial base{};            ///< material of the points that match no colour
  std::vector<ColourMaterial> colours;  ///< at most kMaxMaterials - 1

  [[nodiscard]] bool by_colour() const { return !colours.empty(); }
  /// Index of the material for a colour: i + 1 for the nearest colours[i] within its tolerance (the
  /// first of equally near ones), or 0 for `base`. Counts it in `matches`, which is empty, or has
  /// one element per element of `colours`.
  [[nodiscard]] std::uint8_t index_of(const Colour& colour,
                                      std::span<ColourMatch> matches = {}) const;
  /// All materials in index order.
  [[nodiscard]] std::vector<core::BlobMaterial> list() const;
};

/// "[255, 0, 0]", as in the file of materials.
[[nodiscard]] std::string colour_text(const Colour& colour);

/// Name of material `index`: "default", or that of its colour.
[[nodiscard]] std::string material_name(const MaterialMap& map, std::size_t index);
/// The same with the colour: "felt, colours within 30 of [255, 0, 0]".
[[nodiscard]] std::string describe_material(const MaterialMap& map, std::size_t index);

}  // namespace tactree::builder
