#pragma once
// Values that depend on the wiring of the board: amplifiers and device. Adapt this file.

#include "tactree/core/configuration/configuration.hpp"
#include "tactree/core/configuration/device_presets.hpp"

namespace tactree::firmware::wiring {

/// Effort of an axis at a duty cycle of 1, N or Nm.
inline constexpr float kEffortAtFullWidth[core::kAxes] = {1.9F, 1.8F, 1.5F};

/// Configuration of the device. The device is homed by hand (HomingMethod::kGivenPose).
inline core::Configuration configuration() {
  core::Configuration configuration;
  core::use_device(core::presets::premium(), configuration);
  configuration.rate_hz = 1000.0F;  // the watchdog requires at least this rate
  return configuration;
}

}  // namespace tactree::firmware::wiring
