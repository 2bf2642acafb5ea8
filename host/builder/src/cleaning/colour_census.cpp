#include "cleaning/colour_census.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace tactree::builder {

std::uint8_t ColourCensus::take(const Colour& colour, const MaterialMap& map) {
  Cell& cell =
      cells_[(colour[0] / kLevels * kLevels + colour[1] / kLevels) * kLevels + colour[2] / kLevels];
  ++cell.points;
  for (std::size_t k = 0; k < colour.size(); ++k) {
    cell.sum[k] += colour[k];
  }
  matches_.resize(map.colours.size());
  return map.index_of(colour, matches_);
}

std::vector<ColourCount> ColourCensus::most_frequent(std::size_t limit) const {
  std::vector<ColourCount> counts;
  for (const Cell& cell : cells_) {
    if (cell.points == 0) {
      continue;
    }
    ColourCount count;
    count.points = cell.points;
    for (std::size_t k = 0; k < count.colour.size(); ++k) {
      count.colour[k] = static_cast<std::uint8_t>((cell.sum[k] + cell.points / 2) / cell.points);
    }
    counts.push_back(count);
  }
  std::stable_sort(counts.begin(), counts.end(),
                   [](const ColourCount& a, const ColourCount& b) { return a.points > b.points; });
  counts.resize(std::min(counts.size(), limit));
  return counts;
}

std::string unused_colour(const ColourMaterial& material, const ColourMatch& match,
                          const std::vector<ColourCount>& found) {
  if (match.points > 0) {
    return fmt::format(
        "no point of the model has the material '{}': the {} points of the scan that have its "
        "colour were dropped (lower --spacing, or see the dropped points of the report)",
        material.name, match.points);
  }
  const double distance = std::sqrt(match.squared_distance);
  if (distance <= material.tolerance) {
    return fmt::format(
        "no point has the material '{}': the points within {:.6g} of its colour are nearer to that "
        "of another material (correct the rgb of one of them)",
        material.name, material.tolerance);
  }
  std::string colours;
  for (const ColourCount& count : found) {
    colours += fmt::format("{}{} {} points", colours.empty() ? "" : ", ", colour_text(count.colour),
                           count.points);
  }
  return fmt::format(
      "no point has the colour of the material '{}': the nearest to {} is {}, at a distance of "
      "{:.0f} (raise its tolerance of {:.6g}, or give another rgb; the scan has {})",
      material.name, colour_text(material.colour), colour_text(match.nearest), std::ceil(distance),
      material.tolerance, colours);
}

}  // namespace tactree::builder
