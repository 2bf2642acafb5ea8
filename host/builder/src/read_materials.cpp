#include "tactree/builder/read_materials.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "tactree/builder/scan.hpp"

namespace tactree::builder {
namespace {

using nlohmann::json;

struct Field {
  const char* key;    // in a file
  const char* brief;  // on the command line
  float core::BlobMaterial::*member;
  double low;
  double high;
};

// Narrower ranges than the blob format allows. Values outside them are not useful for any device.
constexpr Field kFields[] = {
    {"stiffness_N_m", "stiffness", &core::BlobMaterial::stiffness_N_m, 0.1, 1e6},
    {"damping_Ns_m", "damping", &core::BlobMaterial::damping_Ns_m, 0.0, 1e3},
    {"static_friction", "static", &core::BlobMaterial::static_friction, 0.0, 4.0},
    {"dynamic_friction", "dynamic", &core::BlobMaterial::dynamic_friction, 0.0, 4.0},
    {"texture_height_m", "texture_height", &core::BlobMaterial::texture_height_m, 0.0, 0.01},
    {"texture_wavelength_m", "texture_wavelength", &core::BlobMaterial::texture_wavelength_m, 0.0,
     1.0},
};

[[noreturn]] void refuse(const std::string& place, const std::string& cause,
                         const std::string& remedy) {
  throw ReadError(place, "", cause, remedy);
}

constexpr double kTolerance = 30.0;
constexpr double kMaxTolerance = 442.0;  // distance from black to white

std::string known_keys(std::string keys) {
  for (const Field& field : kFields) {
    keys += fmt::format("{}{}", keys.empty() ? "" : ", ", field.key);
  }
  return keys;
}

double number(const json& value, const std::string& place, double low, double high) {
  if (!value.is_number()) {
    refuse(place,
           fmt::format("{} is not a number",
                       value.dump(-1, ' ', false, json::error_handler_t::replace)),
           "write a number, without quotes");
  }
  const double v = value.get<double>();
  if (!(v >= low && v <= high)) {
    refuse(place, fmt::format("{:.6g} is outside {:.6g} .. {:.6g}", v, low, high),
           "choose a value in that range");
  }
  return v;
}

// Checks the relations between the values.
void check(const core::BlobMaterial& m, const std::string& place) {
  if (m.stiffness_N_m <= 0.0F) {
    refuse(place, "stiffness_N_m is missing", "add it, in N/m");
  }
  if (m.dynamic_friction > m.static_friction) {
    refuse(place + ".dynamic_friction",
           fmt::format("{:.6g} is more than static_friction, {:.6g}", m.dynamic_friction,
                       m.static_friction),
           "lower it, or raise static_friction");
  }
  if (m.texture_height_m > 0.5F * m.texture_wavelength_m) {
    refuse(place + ".texture_height_m",
           fmt::format("{:.6g} is more than half of texture_wavelength_m, {:.6g}",
                       m.texture_height_m, m.texture_wavelength_m),
           "lower it, or raise texture_wavelength_m");
  }
}

const json& as_object(const json& value, const std::string& place) {
  if (!value.is_object()) {
    refuse(place, "is not an object", "write it as {\"stiffness_N_m\": 800, ...}");
  }
  return value;
}

/// Returns `material` with the values that `value` specifies. Other keys of `value` must be in
/// `also`.
core::BlobMaterial read_material(const json& value, const std::string& place,
                                 core::BlobMaterial material,
                                 std::initializer_list<const char*> also = {}) {
  for (const auto& [key, entry] : as_object(value, place).items()) {
    const auto* field = std::find_if(std::begin(kFields), std::end(kFields),
                                     [&key = key](const Field& f) { return key == f.key; });
    if (field != std::end(kFields)) {
      material.*(field->member) =
          static_cast<float>(number(entry, place + "." + key, field->low, field->high));
      continue;
    }
    std::string keys;
    bool known = false;
    for (const char* other : also) {
      keys += fmt::format("{}{}", keys.empty() ? "" : ", ", other);
      known = known || key == other;
    }
    if (!known) {
      refuse(place + "." + key, "is not a property of a material",
             "remove it, or use one of " + known_keys(keys));
    }
  }
  check(material, place);
  return material;
}

Colour colour(const json& entry, const std::string& place) {
  const auto rgb = entry.find("rgb");
  if (rgb == entry.end() || !rgb->is_array() || rgb->size() != 3) {
    refuse(place + ".rgb", "is not a list of three numbers", "write it as [255, 0, 0]");
  }
  Colour result{};
  for (std::size_t i = 0; i < 3; ++i) {
    const double channel = number((*rgb)[i], fmt::format("{}.rgb[{}]", place, i), 0.0, 255.0);
    result[i] = static_cast<std::uint8_t>(std::lround(channel));
  }
  return result;
}

ColourMaterial colour_material(const json& entry, const std::string& place,
                               const core::BlobMaterial& base) {
  ColourMaterial result;
  result.material = read_material(entry, place, base, {"name", "rgb", "tolerance"});
  result.colour = colour(entry, place);
  const json tolerance = entry.value("tolerance", json(kTolerance));
  result.tolerance = number(tolerance, place + ".tolerance", 0.0, kMaxTolerance);
  const json name = entry.value("name", json(fmt::format("#{:02x}{:02x}{:02x}", result.colour[0],
                                                         result.colour[1], result.colour[2])));
  if (!name.is_string()) {
    refuse(place + ".name", "is not a string", "write it in quotes");
  }
  result.name = name.get<std::string>();
  return result;
}

MaterialMap by_colour(const json& root, const std::string& file) {
  for (const auto& [key, value] : root.items()) {
    if (key != "default" && key != "colours") {
      refuse(file + ": " + key, "is neither \"default\" nor \"colours\"",
             "move the properties into \"default\"");
    }
  }
  if (!root.contains("default")) {
    refuse(file, "\"default\" is missing",
           "add the material of the points whose colour is not listed");
  }
  const json colours = root.value("colours", json::array());
  if (!colours.is_array() || colours.size() >= core::kMaxMaterials) {
    refuse(file + ": colours",
           fmt::format("is not a list of at most {} materials", core::kMaxMaterials - 1),
           "write it as [{\"rgb\": [255, 0, 0], ...}, ...]");
  }
  MaterialMap map;
  map.base = read_material(root["default"], file + ": default", {});
  for (std::size_t i = 0; i < colours.size(); ++i) {
    const std::string place = fmt::format("{}: colours[{}]", file, i);
    map.colours.push_back(colour_material(as_object(colours[i], place), place, map.base));
  }
  return map;
}

json parse(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in || std::filesystem::is_directory(file)) {
    refuse(file, "cannot be read",
           "check the path, or write the material as stiffness=800,damping=1.5,...");
  }
  try {
    return json::parse(in);
  } catch (const json::exception& error) {
    refuse(file, fmt::format("is not JSON: {}", error.what()), "correct the file there");
  }
}

MaterialMap from_text(const std::string& text) {
  MaterialMap map;
  std::set<std::string> named;
  std::size_t from = 0;
  while (from <= text.size()) {
    const std::size_t to = std::min(text.find(',', from), text.size());
    const std::string item = text.substr(from, to - from);
    const std::size_t equals = item.find('=');
    const std::string name = item.substr(0, equals);
    const auto* field = std::find_if(std::begin(kFields), std::end(kFields),
                                     [&](const Field& f) { return name == f.brief; });
    if (equals == std::string::npos || field == std::end(kFields)) {
      refuse("--material", fmt::format("'{}' is not a property of a material", item),
             "use stiffness=, damping=, static=, dynamic=, texture_height=, texture_wavelength=");
    }
    if (!named.insert(name).second) {
      refuse("--material", fmt::format("{} is given twice", name), "give one value");
    }
    const json value = json::parse(item.substr(equals + 1), nullptr, false);
    map.base.*(field->member) =
        static_cast<float>(number(value.is_discarded() ? json(item.substr(equals + 1)) : value,
                                  "--material: " + name, field->low, field->high));
    from = to + 1;
  }
  check(map.base, "--material");
  return map;
}

}  // namespace

MaterialMap read_materials(const std::string& source) {
  std::error_code unknown;
  if (source.find('=') != std::string::npos && !std::filesystem::exists(source, unknown)) {
    return from_text(source);
  }
  const json root = parse(source);
  const json& object = as_object(root, source);
  if (object.contains("default") || object.contains("colours")) {
    return by_colour(object, source);
  }
  MaterialMap map;
  map.base = read_material(object, source + ": material", {});
  return map;
}

}  // namespace tactree::builder
