#pragma once
// The contact parameters that a page may change, by their names in JSON: stiffness_N_m,
// damping_Ns_m, static_friction, dynamic_friction, texture_height_m, texture_wavelength_m,
// use_materials.

#include <nlohmann/json.hpp>
#include <string>

#include "tactree/core/configuration/configuration.hpp"
#include "tactree/viewer/source.hpp"

namespace tactree::viewer {

/// Throws SessionRefused.
[[nodiscard]] float number_of(const std::string& key, const nlohmann::json& value);

/// Returns false if `key` is not a contact parameter. Throws SessionRefused.
[[nodiscard]] bool set_contact_parameters(core::Configuration& configuration,
                                          const std::string& key, const nlohmann::json& value);
[[nodiscard]] nlohmann::json contact_parameters_json(const core::Configuration& configuration);

/// The exception for a setting that a source does not have.
[[nodiscard]] SessionRefused no_such_setting(const std::string& key);

}  // namespace tactree::viewer
