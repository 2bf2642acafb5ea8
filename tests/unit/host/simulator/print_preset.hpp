#pragma once
// Name of a preset in a parametrised test.

#include <ostream>

#include "tactree/core/configuration/device_presets.hpp"

namespace tactree::core {

inline void PrintTo(const DevicePreset& preset, std::ostream* out) { *out << preset.name; }

}  // namespace tactree::core
