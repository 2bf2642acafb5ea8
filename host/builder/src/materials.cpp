#include "tactree/builder/materials.hpp"

#include <fmt/core.h>

#include <cstddef>

namespace tactree::builder {
namespace {

double squared_distance(const Colour& a, const Colour& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double difference = static_cast<double>(a[i]) - static_cast<double>(b[i]);
    sum += difference * difference;
  }
  return sum;
}

}  // namespace

std::uint8_t MaterialMap::index_of(const Colour& colour, std::span<ColourMatch> matches) const {
  std::size_t best = 0;
  double best_squared = 0.0;
  for (std::size_t i = 0; i < colours.size(); ++i) {
    const double squared = squared_distance(colour, colours[i].colour);
    const bool meant = squared <= colours[i].tolerance * colours[i].tolerance;
    if (meant && (best == 0 || squared < best_squared)) {
      best = i + 1;
      best_squared = squared;
    }
    if (!matches.empty() && squared < matches[i].squared_distance) {
      matches[i].squared_distance = squared;
      matches[i].nearest = colour;
    }
  }
  if (!matches.empty() && best != 0) {
    ++matches[best - 1].points;
  }
  return static_cast<std::uint8_t>(best);
}

std::vector<core::BlobMaterial> MaterialMap::list() const {
  std::vector<core::BlobMaterial> all = {base};
  for (const ColourMaterial& entry : colours) {
    all.push_back(entry.material);
  }
  return all;
}

std::string colour_text(const Colour& colour) {
  return fmt::format("[{}, {}, {}]", colour[0], colour[1], colour[2]);
}

std::string material_name(const MaterialMap& map, std::size_t index) {
  return index == 0 ? "default" : map.colours[index - 1].name;
}

std::string describe_material(const MaterialMap& map, std::size_t index) {
  if (index == 0) {
    return map.by_colour() ? "default, all other colours" : "default";
  }
  const ColourMaterial& entry = map.colours[index - 1];
  return fmt::format("{}, colours within {:.6g} of {}", entry.name, entry.tolerance,
                     colour_text(entry.colour));
}

}  // namespace tactree::builder
