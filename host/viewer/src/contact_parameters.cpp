#include "contact_parameters.hpp"

#include <array>
#include <utility>

namespace tactree::viewer {
namespace {

using Parameter = std::pair<const char*, float core::Configuration::*>;
constexpr std::array<Parameter, 4> kParameters = {
    {{"stiffness_N_m", &core::Configuration::stiffness_N_m},
     {"damping_Ns_m", &core::Configuration::damping_Ns_m},
     {"static_friction", &core::Configuration::static_friction},
     {"dynamic_friction", &core::Configuration::dynamic_friction}}};

}  // namespace

float number_of(const std::string& key, const nlohmann::json& value) {
  if (!value.is_number()) {
    throw SessionRefused(key + ": not a number");
  }
  return value.get<float>();
}

bool set_contact_parameters(core::Configuration& contact, const std::string& key,
                            const nlohmann::json& value) {
  for (const auto& [name, parameter] : kParameters) {
    if (key == name) {
      contact.*parameter = number_of(key, value);
      return true;
    }
  }
  if (key == "use_materials" && value.is_boolean()) {
    contact.use_materials = value.get<bool>();
    return true;
  }
  return false;
}

nlohmann::json contact_parameters_json(const core::Configuration& contact) {
  nlohmann::json json = {{"use_materials", contact.use_materials}};
  for (const auto& [name, parameter] : kParameters) {
    json[name] = contact.*parameter;
  }
  return json;
}

SessionRefused no_such_setting(const std::string& key) {
  return SessionRefused(key + ": unknown setting, or of a wrong type");
}

}  // namespace tactree::viewer
