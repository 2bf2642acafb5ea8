#include "feel.hpp"

#include <array>
#include <utility>

namespace tactree::viewer {
namespace {

using Figure = std::pair<const char*, float core::Configuration::*>;
constexpr std::array<Figure, 4> kFigures = {
    {{"stiffness_N_m", &core::Configuration::stiffness_N_m},
     {"damping_Ns_m", &core::Configuration::damping_Ns_m},
     {"static_friction", &core::Configuration::static_friction},
     {"dynamic_friction", &core::Configuration::dynamic_friction}}};

}  // namespace

float number_of(const std::string& key, const nlohmann::json& value) {
  if (!value.is_number()) {
    throw SessionRefused(key + ": it is not a number");
  }
  return value.get<float>();
}

bool set_feel(core::Configuration& feel, const std::string& key, const nlohmann::json& value) {
  for (const auto& [name, figure] : kFigures) {
    if (key == name) {
      feel.*figure = number_of(key, value);
      return true;
    }
  }
  if (key == "use_materials" && value.is_boolean()) {
    feel.use_materials = value.get<bool>();
    return true;
  }
  return false;
}

nlohmann::json feel_json(const core::Configuration& feel) {
  nlohmann::json json = {{"use_materials", feel.use_materials}};
  for (const auto& [name, figure] : kFigures) {
    json[name] = feel.*figure;
  }
  return json;
}

SessionRefused no_such_setting(const std::string& key) {
  return SessionRefused(key + ": there is no such setting, or not of this kind");
}

}  // namespace tactree::viewer
