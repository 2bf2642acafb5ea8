#pragma once
// What a page may change of how the contact feels, by the names of its settings: stiffness_N_m,
// damping_Ns_m, static_friction, dynamic_friction, use_materials.

#include <nlohmann/json.hpp>
#include <string>

#include "tactree/core/configuration.hpp"
#include "tactree/viewer/source.hpp"

namespace tactree::viewer {

/// Throws SessionRefused.
[[nodiscard]] float number_of(const std::string& key, const nlohmann::json& value);

/// False: the setting is none of these. Throws SessionRefused.
[[nodiscard]] bool set_feel(core::Configuration& feel, const std::string& key,
                            const nlohmann::json& value);
[[nodiscard]] nlohmann::json feel_json(const core::Configuration& feel);

/// Of a setting that a source does not have.
[[nodiscard]] SessionRefused no_such_setting(const std::string& key);

}  // namespace tactree::viewer
