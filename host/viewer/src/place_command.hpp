#pragma once
// Reads the command "place" of a page.

#include <nlohmann/json_fwd.hpp>

#include "tactree/simulation/placement.hpp"

namespace tactree::viewer {

/// Pose and scale of {"do": "place", "pose": [16 numbers], "scale": 1.2}, frame of the device.
/// Throws SessionRefused.
[[nodiscard]] simulation::Placement placement_of(const nlohmann::json& command);

/// A page sends the scale back as it was told, apart from rounding.
[[nodiscard]] bool is_same_scale(double a, double b);

}  // namespace tactree::viewer
