#include "contact_parameters.hpp"

#include <array>
#include <utility>

namespace tactree::viewer {
namespace {

using Parameter = std::pair<const char*, float core::ContactParameters::*>;
constexpr std::array<Parameter, 6> kParameters = {
    {{"stiffness_N_m", &core::ContactParameters::stiffness_N_m},
     {"damping_Ns_m", &core::ContactParameters::damping_Ns_m},
     {"static_friction", &core::ContactParameters::static_friction},
     {"dynamic_friction", &core::ContactParameters::dynamic_friction},
     {"texture_height_m", &core::ContactParameters::texture_height_m},
     {"texture_wavelength_m", &core::ContactParameters::texture_wavelength_m}}};

}  // namespace

float number_of(const std::string& key, const nlohmann::json& value) {
  if (!value.is_number()) {
    throw SessionRefused(key + ": not a number");
  }
  return value.get<float>();
}

bool set_contact_parameters(core::Configuration& configuration, const std::string& key,
                            const nlohmann::json& value) {
  for (const auto& [name, parameter] : kParameters) {
    if (key == name) {
      configuration.contact.*parameter = number_of(key, value);
      return true;
    }
  }
  if (key == "use_materials" && value.is_boolean()) {
    configuration.use_materials = value.get<bool>();
    return true;
  }
  return false;
}

nlohmann::json contact_parameters_json(const core::Configuration& configuration) {
  nlohmann::json json = {{"use_materials", configuration.use_materials}};
  for (const auto& [name, parameter] : kParameters) {
    json[name] = configuration.contact.*parameter;
  }
  return json;
}

SessionRefused no_such_setting(const std::string& key) {
  return SessionRefused(key + ": unknown setting, or of a wrong type");
}

}  // namespace tactree::viewer
