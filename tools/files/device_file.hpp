#pragma once
// Devices by name, and devices that users describe in a JSON file.

#include <string>
#include <vector>

#include "tactree/core/device_presets.hpp"

namespace tactree::cli {

struct Device {
  std::string name;
  std::string about;
  core::DevicePreset figures{};  ///< its own name and about are not used
};

/// "cartesian", "premium", ...
[[nodiscard]] std::vector<std::string> device_names();

/// The preset of this name, or else the device that the file of this name describes. Throws
/// CommandError: "file: key: cause (remedy)".
[[nodiscard]] Device load_device(const std::string& name_or_file);

/// The device as such a file.
[[nodiscard]] std::string device_json(const Device& device);

}  // namespace tactree::cli
