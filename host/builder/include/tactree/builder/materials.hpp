#pragma once
// Materials of a model, and the assignment of the points of a coloured scan to them.

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "tactree/core/model/blob_format.hpp"

namespace tactree::builder {

using Colour = std::array<std::uint8_t, 3>;  ///< R, G, B

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
  /// first of equally near ones), or 0 for `base`.
  [[nodiscard]] std::uint8_t index_of(const Colour& colour) const;
  /// All materials in index order.
  [[nodiscard]] std::vector<core::BlobMaterial> list() const;
};

}  // namespace tactree::builder
