#pragma once
// Haptic devices: presets by name, and descriptions in JSON files (`tactree simulate
// --dump-device`).

#include <string>
#include <vector>

#include "tactree/core/configuration/device_presets.hpp"

namespace tactree::support {

struct Device {
  std::string name;
  std::string about;
  core::DevicePreset preset{};  ///< its name and description are not used
};

/// Names of all presets: "cartesian", "premium", ...
[[nodiscard]] std::vector<std::string> device_names();

/// Returns the preset of this name or, if there is none, the device in the file of this name.
/// Throws UserError with the text "file: key: cause (hint)".
[[nodiscard]] Device load_device(const std::string& name_or_file);

/// Returns the device as the text of a device file.
[[nodiscard]] std::string device_json(const Device& device);

}  // namespace tactree::support
