#include "tactree/support/device_file.hpp"

#include <fmt/core.h>

#include <nlohmann/json.hpp>

#include "device_fields.hpp"
#include "tactree/support/blob_facts.hpp"
#include "tactree/support/json_text.hpp"
#include "tactree/support/user_error.hpp"

namespace tactree::support {

std::vector<std::string> device_names() {
  std::vector<std::string> names;
  for (const core::DevicePreset& preset : core::kDevicePresets) {
    names.emplace_back(preset.name);
  }
  return names;
}

Device load_device(const std::string& name_or_file) {
  for (const core::DevicePreset& preset : core::kDevicePresets) {
    if (name_or_file == preset.name) {
      return {preset.name, preset.about, preset};
    }
  }
  DeviceReading reading = read_device(name_or_file);
  std::string message;
  for (const DeviceMistake& mistake : reading.mistakes) {
    message += (message.empty() ? "" : "\n") + mistake_text(name_or_file, mistake);
  }
  if (!message.empty()) {
    throw UserError(message);
  }
  return std::move(reading.device);
}

std::string device_json(const Device& device) {
  nlohmann::ordered_json json;
  json["name"] = device.name;
  json["about"] = device.about;
  json["kind"] = kKindNames[static_cast<std::size_t>(device.preset.model.kind)];
  json["homing"] = kHomingNames[static_cast<std::size_t>(device.preset.model.homing)];
  core::DevicePreset preset = device.preset;
  for (const DeviceField& field : device_fields()) {
    if (!field.belongs_to(preset.model.kind)) {
      continue;
    }
    const DeviceValues values = field.values(preset);
    if (field.per_axis()) {
      json[field.key] = {shortest_double(*values[0]), shortest_double(*values[1]),
                         shortest_double(*values[2])};
    } else {
      json[field.key] = shortest_double(*values[0]);
    }
  }
  return json_text(json);
}

}  // namespace tactree::support
