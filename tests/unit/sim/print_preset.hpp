#pragma once
// How a test that is repeated for each preset names it.

#include <ostream>

#include "tactree/core/device_presets.hpp"

namespace tactree::core {

inline void PrintTo(const DevicePreset& preset, std::ostream* out) { *out << preset.name; }

}  // namespace tactree::core
