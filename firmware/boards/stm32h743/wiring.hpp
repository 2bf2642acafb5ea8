#pragma once
// Values that depend on the wiring of the board: amplifiers and device. Adapt this file.

#include "tactree/core/configuration/configuration.hpp"
#include "tactree/core/configuration/device_presets.hpp"

namespace tactree::firmware::wiring {

/// Effort of an axis at a duty cycle of 1, N or Nm.
inline constexpr float kEffortAtFullWidth[core::kAxes] = {1.9F, 1.8F, 1.5F};

/// Set it after the first force has shown that every motor pushes the right way: README.md, "First
/// power-on". Until then the board gives at most 0.5 N, and does not carry the weight of the device
/// (core::first_force()).
inline constexpr bool kSignsProven = false;

/// Configuration of the device. The device is homed by hand (HomingMethod::kGivenPose).
inline core::Configuration configuration(bool signs_proven = kSignsProven) {
  core::Configuration configuration;
  core::use_device(core::presets::premium(), configuration);
  configuration.rate_hz = 1000.0F;  // the watchdog requires at least this rate
  return signs_proven ? configuration : core::first_force(configuration);
}

}  // namespace tactree::firmware::wiring
