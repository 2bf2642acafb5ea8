// The units of length in the two forms in which LAS files state their coordinate system.

#include <algorithm>
#include <array>
#include <cmath>

#include "las_header.hpp"
#include "number.hpp"
#include "scalar.hpp"

namespace tactree::builder {
namespace {

/// Unit of an EPSG code, metres.
std::optional<double> unit_of_code(std::uint16_t code) {
  switch (code) {
    case 9001:
      return 1.0;
    case 9002:
      return 0.3048;
    case 9003:
      return 1200.0 / 3937.0;  // US survey foot
    default:
      return std::nullopt;
  }
}

/// Returns the text from `keyword` to the bracket that closes it; empty if there is none.
std::string_view block_of(std::string_view text, std::string_view keyword) {
  const std::size_t begin = text.find(keyword);
  if (begin == std::string_view::npos) return {};
  int depth = 0;
  bool quoted = false;
  for (std::size_t at = begin; at < text.size(); ++at) {
    if (text[at] == '"') quoted = !quoted;
    if (quoted) continue;
    if (text[at] == '[') ++depth;
    if (text[at] == ']' && --depth == 0) return text.substr(begin, at - begin);
  }
  return {};
}

/// Value of the last UNIT or LENGTHUNIT of a block, which is the unit of its axes.
std::optional<double> unit_of_block(std::string_view block) {
  const std::size_t unit = block.rfind("UNIT[");
  if (unit == std::string_view::npos) return std::nullopt;
  if (block.substr(0, unit).ends_with("ANGLE")) return std::nullopt;
  std::string_view rest = block.substr(unit);
  const std::size_t quote = rest.find('"');
  const std::size_t end = quote == rest.npos ? rest.npos : rest.find('"', quote + 1);
  const std::size_t comma = end == rest.npos ? rest.npos : rest.find(',', end);
  if (comma == rest.npos) return std::nullopt;
  rest.remove_prefix(comma + 1);
  double metres = 0.0;
  if (!parse_number(trim(rest.substr(0, rest.find_first_of(",]"))), metres)) return std::nullopt;
  return metres > 0.0 && std::isfinite(metres) ? std::optional(metres) : std::nullopt;
}

std::optional<double> unit_of_first(std::string_view text,
                                    const std::array<std::string_view, 2>& keywords) {
  for (const std::string_view keyword : keywords) {
    if (const auto unit = unit_of_block(block_of(text, keyword))) return unit;
  }
  return std::nullopt;
}

}  // namespace

void add_geo_keys(std::string_view directory, LasUnits& units) {
  constexpr std::size_t kKeyBytes = 8;  // key, location, count, value
  for (std::size_t at = kKeyBytes; at + kKeyBytes <= directory.size(); at += kKeyBytes) {
    const auto word = [&](std::size_t i) {
      return load_bits<std::uint16_t, false>(directory.data() + at + 2 * i);
    };
    if (word(1) != 0) continue;  // the value is in another tag: no code
    if (word(0) == 1024) units.degrees = word(3) == 2;
    if (word(0) == 3076) units.horizontal = unit_of_code(word(3));
    if (word(0) == 4099) units.vertical = unit_of_code(word(3));
  }
}

void add_well_known_text(std::string_view text, LasUnits& units) {
  const std::array<std::string_view, 2> plane = {"PROJCS[", "PROJCRS["};
  const bool planar = std::any_of(plane.begin(), plane.end(), [&](std::string_view keyword) {
    return text.find(keyword) != std::string_view::npos;
  });
  const bool local = text.find("LOCAL_CS[") != std::string_view::npos ||
                     text.find("ENGCRS[") != std::string_view::npos;
  units.horizontal =
      planar ? unit_of_first(text, plane) : unit_of_first(text, {"LOCAL_CS[", "ENGCRS["});
  units.vertical = unit_of_first(text, {"VERT_CS[", "VERTCRS["});
  units.degrees = !planar && !local && text.find("GEOG") != std::string_view::npos;
}

}  // namespace tactree::builder
