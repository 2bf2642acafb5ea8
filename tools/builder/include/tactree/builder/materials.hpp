#pragma once
// What a model is made of, and which points of a coloured scan are of which material.

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "tactree/core/blob_format.hpp"

namespace tactree::builder {

using Colour = std::array<std::uint8_t, 3>;  ///< R, G, B

struct ColourMaterial {
  std::string name;
  Colour colour{};
  double tolerance = 0.0;  ///< distance in R, G, B up to which a colour is meant
  core::BlobMaterial material{};
};

struct MaterialMap {
  core::BlobMaterial base{};            ///< of every point that no colour claims
  std::vector<ColourMaterial> colours;  ///< at most kMaxMaterials - 1

  [[nodiscard]] bool by_colour() const { return !colours.empty(); }
  /// 0: base; i + 1: colours[i], the nearest of those within their tolerance, the first of equals.
  [[nodiscard]] std::uint8_t index_of(const Colour& colour) const;
  /// In the order of the indices.
  [[nodiscard]] std::vector<core::BlobMaterial> list() const;
};

}  // namespace tactree::builder
