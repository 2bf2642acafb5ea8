// The units of length in the two forms in which LAS files state their coordinate system.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "las_header.hpp"
#include "number.hpp"
#include "scalar.hpp"

namespace tactree::builder {
namespace {

constexpr std::uint16_t kUserDefined = 32767;
constexpr double kUsSurveyFoot = 1200.0 / 3937.0;

struct CodedUnit {
  std::uint16_t code;
  double metres;
};

/// Codes of EPSG.
constexpr CodedUnit kCodedUnits[] = {
    {1025, 0.001},            // millimetre
    {1033, 0.01},             // centimetre
    {9001, 1.0},              //
    {9002, 0.3048},           // international foot
    {9003, kUsSurveyFoot},    //
    {9005, 0.3047972654},     // Clarke's foot
    {9036, 1000.0},           // kilometre
    {9041, 0.3047994715387},  // British foot of 1922
    {9080, 0.3047995102481},  // Indian foot
    {9093, 1609.344},         // mile
    {9094, 0.3047997101815},  // Gold Coast foot
    {9095, 0.3048007491},     // British foot of 1936
    {9096, 0.9144},           // yard
};

struct CodeRange {
  std::uint16_t first;
  std::uint16_t last;
};

/// Projected coordinate systems in metres: UTM, and the grids of some countries.
constexpr CodeRange kMetricGrids[] = {
    {32601, 32660}, {32701, 32760}, {32201, 32260}, {32301, 32360}, {25828, 25838},
    {26901, 26923}, {26703, 26722}, {28348, 28358}, {7846, 7859},   {6669, 6687},
    {31466, 31469}, {2056, 2056},   {2154, 2154},   {2193, 2193},   {3006, 3006},
    {3035, 3035},   {3067, 3067},   {3857, 3857},   {27700, 27700}, {28992, 28992}};
/// Heights in metres: above an ellipsoid, by keys of old, then above the sea.
constexpr CodeRange kMetricHeights[] = {
    {5001, 5035}, {3855, 3855}, {3900, 3900}, {5613, 5613}, {5621, 5621}, {5701, 5701},
    {5703, 5703}, {5705, 5705}, {5709, 5714}, {5717, 5717}, {5720, 5720}, {5728, 5729},
    {5773, 5773}, {5776, 5776}, {5778, 5778}, {5783, 5783}, {5798, 5799}, {5941, 5941},
    {6647, 6647}, {6695, 6695}, {7837, 7837}, {7839, 7839}, {9389, 9389}};
/// Heights in feet above the sea at the coasts of North America.
constexpr CodedUnit kHeightsInFeet[] = {
    {5702, kUsSurveyFoot}, {6360, kUsSurveyFoot}, {8228, 0.3048}};

template <std::size_t N>
std::optional<double> unit_of_code(const CodedUnit (&units)[N], std::uint16_t code) {
  for (const CodedUnit& unit : units) {
    if (unit.code == code) return unit.metres;
  }
  return std::nullopt;
}

template <std::size_t N>
bool is_in(const CodeRange (&ranges)[N], std::uint16_t code) {
  return std::any_of(std::begin(ranges), std::end(ranges), [code](const CodeRange& range) {
    return code >= range.first && code <= range.last;
  });
}

/// The keys of a GeoTIFF directory. A code of 0 is undefined, as if its key were missing.
class GeoKeys {
 public:
  GeoKeys(std::string_view directory, std::string_view numbers) : numbers_(numbers) {
    constexpr std::size_t kKeyBytes = 8;  // key, location, count, value
    for (std::size_t at = kKeyBytes; at + kKeyBytes <= directory.size(); at += kKeyBytes) {
      const auto word = [&](std::size_t i) {
        return load_bits<std::uint16_t, false>(directory.data() + at + 2 * i);
      };
      if (word(1) == 0) codes_[word(0)] = word(3);
      if (word(1) == kNumbersTag) number_at_[word(0)] = word(3);
    }
  }

  [[nodiscard]] std::uint16_t code(std::uint16_t key) const {
    const auto found = codes_.find(key);
    return found == codes_.end() ? std::uint16_t{0} : found->second;
  }

  /// A size in metres.
  [[nodiscard]] std::optional<double> size(std::uint16_t key) const {
    const auto found = number_at_.find(key);
    if (found == number_at_.end()) return std::nullopt;
    const std::size_t at = sizeof(double) * found->second;
    if (at + sizeof(double) > numbers_.size()) return std::nullopt;
    const double metres = load_scalar<false>(numbers_.data() + at, ScalarType::kFloat64);
    return metres > 0.0 && std::isfinite(metres) ? std::optional(metres) : std::nullopt;
  }

 private:
  static constexpr std::uint16_t kNumbersTag = 34736;

  std::string_view numbers_;
  std::map<std::uint16_t, std::uint16_t> codes_;
  std::map<std::uint16_t, std::uint16_t> number_at_;
};

constexpr std::uint16_t kModelType = 1024;
constexpr std::uint16_t kGeographicSystem = 2048;
constexpr std::uint16_t kAngularUnit = 2054;
constexpr std::uint16_t kProjectedSystem = 3072;
constexpr std::uint16_t kLinearUnit = 3076;
constexpr std::uint16_t kLinearUnitSize = 3077;
constexpr std::uint16_t kVerticalSystem = 4096;
constexpr std::uint16_t kVerticalUnit = 4099;

void set_horizontal(const GeoKeys& keys, LasUnits& units) {
  const std::uint16_t unit = keys.code(kLinearUnit);
  const std::uint16_t system = keys.code(kProjectedSystem);
  if (unit != 0 && unit != kUserDefined) {
    units.horizontal = unit_of_code(kCodedUnits, unit);
    if (!units.horizontal) units.unknown = fmt::format("the unit of length EPSG:{}", unit);
    return;
  }
  units.horizontal = keys.size(kLinearUnitSize);
  if (units.horizontal) return;
  if (unit == kUserDefined) {
    units.unknown = "a unit of length of its own, without a usable size";
  } else if (system == kUserDefined) {
    units.unknown = "a coordinate system of its own, without a unit";
  } else if (is_in(kMetricGrids, system)) {
    units.horizontal = 1.0;
  } else if (system != 0) {
    units.unknown = fmt::format("only the coordinate system EPSG:{}, without its unit", system);
  }
}

void set_vertical(const GeoKeys& keys, LasUnits& units) {
  const std::uint16_t unit = keys.code(kVerticalUnit);
  const std::uint16_t system = keys.code(kVerticalSystem);
  if (unit != 0 && unit != kUserDefined) {
    units.vertical = unit_of_code(kCodedUnits, unit);
    if (!units.vertical) units.unknown_height = fmt::format("the unit of length EPSG:{}", unit);
  } else if (unit == kUserDefined) {
    units.unknown_height = "a unit of length of its own";
  } else if (is_in(kMetricHeights, system)) {
    units.vertical = 1.0;
  } else if (system != 0 && system != kUserDefined) {
    units.vertical = unit_of_code(kHeightsInFeet, system);
    if (!units.vertical) {
      units.unknown_height = fmt::format("only the coordinate system EPSG:{}", system);
    }
  }
}

LasUnits units_of_keys(const GeoKeys& keys) {
  LasUnits units;
  const bool projected = keys.code(kProjectedSystem) != 0 || keys.code(kLinearUnit) != 0;
  const bool geographic = keys.code(kGeographicSystem) != 0 || keys.code(kAngularUnit) != 0;
  const std::uint16_t model = keys.code(kModelType);
  units.degrees = model == 2 || (model == 0 && geographic && !projected);
  set_horizontal(keys, units);
  set_vertical(keys, units);
  return units;
}

/// Returns the text in one form: capitals, no white space, no names in quotes, '[' for '('.
std::string plain_text(std::string_view text) {
  std::string plain;
  bool quoted = false;
  for (const char c : text) {
    if (c == '"') quoted = !quoted;
    if (quoted || c == '"' || c <= ' ' || c > '~') continue;
    if (c == '(' || c == ')') {
      plain += c == '(' ? '[' : ']';
    } else {
      plain += c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
    }
  }
  return plain;
}

/// Number of a unit whose contents begin at `at`: "UNIT[name,0.3048,...".
std::optional<double> unit_at(std::string_view text, std::size_t at) {
  const std::size_t comma = text.find(',', at);
  if (comma == text.npos) return std::nullopt;
  const std::size_t end = text.find_first_of(",]", comma + 1);
  double metres = 0.0;
  if (end == text.npos || !parse_number(text.substr(comma + 1, end - comma - 1), metres)) {
    return std::nullopt;
  }
  return metres > 0.0 && std::isfinite(metres) ? std::optional(metres) : std::nullopt;
}

/// Unit of the axes of the coordinate system that begins with `keyword`, "PROJCS[" for example. The
/// units within its other parts are those of its ellipsoid, its parameters and its extent.
std::optional<double> unit_of_system(std::string_view text, std::string_view keyword) {
  const std::size_t begin = text.find(keyword);
  if (begin == text.npos) return std::nullopt;
  std::optional<double> unit;
  std::string_view part;
  int depth = 0;
  std::size_t word = begin;
  for (std::size_t at = begin; at < text.size(); ++at) {
    const char c = text[at];
    if (c != '[' && c != ']' && c != ',') continue;
    if (c == '[') {
      const std::string_view name = text.substr(word, at - word);
      if (depth == 1) part = name;
      const bool of_axes = depth == 1 || (depth == 2 && part == "AXIS");
      if (of_axes && (name == "UNIT" || name == "LENGTHUNIT")) unit = unit_at(text, at);
      ++depth;
    }
    if (c == ']' && --depth == 0) return unit;
    word = at + 1;
  }
  return std::nullopt;  // the text is cut off
}

template <std::size_t N>
std::string_view first_in(std::string_view text, const std::array<std::string_view, N>& keywords) {
  const auto found = std::find_if(keywords.begin(), keywords.end(), [&](std::string_view keyword) {
    return text.find(keyword) != text.npos;
  });
  return found == keywords.end() ? std::string_view() : *found;
}

LasUnits units_of_text(std::string_view well_known_text) {
  constexpr std::array<std::string_view, 9> kPlane = {"PROJCS[",   "PROJCRS[", "PROJECTEDCRS[",
                                                      "LOCAL_CS[", "ENGCRS[",  "ENGINEERINGCRS[",
                                                      "GEOCCS[",   "GEODCRS[", "GEODETICCRS["};
  constexpr std::array<std::string_view, 4> kEllipsoid = {"GEOGCS[", "GEOGCRS[", "GEOGRAPHICCRS[",
                                                          "CS[ELLIPSOIDAL"};
  constexpr std::array<std::string_view, 4> kHeights = {"VERT_CS[", "VERTCS[", "VERTCRS[",
                                                        "VERTICALCRS["};
  const std::string text = plain_text(well_known_text);
  LasUnits units;
  if (text.empty()) return units;
  const std::string_view plane = first_in(text, kPlane);
  const bool by_angles = plane.empty() || plane.starts_with("GEOD");
  units.degrees = by_angles && !first_in(text, kEllipsoid).empty();
  if (!plane.empty() && !units.degrees) units.horizontal = unit_of_system(text, plane);
  const std::string_view heights = first_in(text, kHeights);
  if (!heights.empty()) {
    units.vertical = unit_of_system(text, heights);
    if (!units.vertical) units.unknown_height = "no unit that can be read";
  }
  if (!units.horizontal) units.unknown = "a coordinate system in text without a unit of length";
  return units;
}

bool are_different(const std::optional<double>& a, const std::optional<double>& b) {
  return a && b && std::abs(*a - *b) > 1e-9 * *a;
}

}  // namespace

LasUnits units_of(const LasProjection& projection) {
  LasUnits units = units_of_keys(GeoKeys(projection.keys, projection.numbers));
  LasUnits other = units_of_text(projection.text);
  if (projection.text_rules) std::swap(units, other);
  units.differ = are_different(units.horizontal, other.horizontal) ||
                 are_different(units.vertical, other.vertical);
  if (!units.horizontal) {
    units.degrees = units.degrees || other.degrees;
    units.horizontal = other.horizontal;
    if (units.unknown.empty()) units.unknown = other.unknown;
  }
  if (!units.vertical) {
    units.vertical = other.vertical;
    if (units.unknown_height.empty()) units.unknown_height = other.unknown_height;
  }
  if (units.horizontal || units.degrees) units.unknown.clear();
  if (units.vertical || units.degrees) units.unknown_height.clear();
  return units;
}

}  // namespace tactree::builder
