#pragma once
// The colours of the points of a scan, for messages about materials that no point has.

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "tactree/builder/materials.hpp"

namespace tactree::builder {

/// Counts points by colour; similar ones, which differ in the lower half of a byte, together.
class ColourCensus {
 public:
  /// Counts a point and returns map.index_of(colour). Every call has the same map.
  std::uint8_t take(const Colour& colour, const MaterialMap& map);

  /// At most `limit` colours, each the mean of the points that are counted together, with the most
  /// frequent one first.
  [[nodiscard]] std::vector<ColourCount> most_frequent(std::size_t limit) const;

  /// One per colour of the map; empty without points.
  [[nodiscard]] const std::vector<ColourMatch>& matches() const { return matches_; }

 private:
  static constexpr std::size_t kLevels = 16;  // per channel

  struct Cell {
    std::uint64_t points = 0;
    std::array<std::uint64_t, 3> sum{};
  };

  std::vector<Cell> cells_ = std::vector<Cell>(kLevels * kLevels * kLevels);
  std::vector<ColourMatch> matches_;
};

/// A warning about a material whose colour no point of the model has. `found`: the most frequent
/// colours of the scan.
[[nodiscard]] std::string unused_colour(const ColourMaterial& material, const ColourMatch& match,
                                        const std::vector<ColourCount>& found);

}  // namespace tactree::builder
