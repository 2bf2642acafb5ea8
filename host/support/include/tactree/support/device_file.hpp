#pragma once
// Haptic devices: presets by name, and descriptions in JSON files (`tactree device`, `tactree
// simulate --dump-device`).

#include <cstddef>
#include <string>
#include <vector>

#include "tactree/core/configuration/device_presets.hpp"

namespace tactree::support {

/// A value that a device file does not state.
struct DeviceDefault {
  std::string field;
  std::string value;        ///< as in a file: "given-pose", "0", "[0, 0, 0]"
  std::string consequence;  ///< "the weight of the links is not compensated"
};

struct Device {
  std::string name;
  std::string about;
  core::DevicePreset preset{};            ///< its name and description are not used
  std::vector<DeviceDefault> defaults{};  ///< those in use, in the order of the keys
};

/// A mistake in a device file. Line and column, from 1, are those of the key or value; of a missing
/// key those of the object.
struct DeviceMistake {
  std::size_t line = 1;
  std::size_t column = 1;
  std::string field;  ///< "joint_min[1]"; empty: the whole file
  std::string cause;
  std::string remedy;
};

struct DeviceReading {
  Device device;  ///< valid only without mistakes
  std::vector<DeviceMistake> mistakes;
};

/// Names of all presets: "cartesian", "premium", ...
[[nodiscard]] std::vector<std::string> device_names();

/// Reads a device file and finds all mistakes in it, in the order of the lines; after the first
/// hundred an entry states that there are more. Throws UserError if the file cannot be read.
[[nodiscard]] DeviceReading read_device(const std::string& file);

/// Returns the preset of this name or, if there is none, the device in the file of this name.
/// Throws UserError with a line "file:line:column: field: cause (hint)" for each mistake.
[[nodiscard]] Device load_device(const std::string& name_or_file);

/// "file:line:column: field: cause (hint)"
[[nodiscard]] std::string mistake_text(const std::string& file, const DeviceMistake& mistake);

/// The defaults in use, "homing = given-pose, tip_mass_kg = 0"; empty if there are none.
[[nodiscard]] std::string defaults_text(const Device& device);

/// Returns the device as the text of a device file. It states every value.
[[nodiscard]] std::string device_json(const Device& device);

/// Returns the JSON schema (draft 7) of device files. It has the keys, types, ranges and defaults;
/// relations between values are checked by read_device() only.
[[nodiscard]] std::string device_schema();

/// Returns a C++ header that defines the device as a constexpr core::DevicePreset named `variable`.
/// Each float has the same bits as in `device`. `source`: the name of its file, for a comment.
[[nodiscard]] std::string device_header(const Device& device, const std::string& variable,
                                        const std::string& source);

}  // namespace tactree::support
