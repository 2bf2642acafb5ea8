#pragma once
// Calibration values of a Configuration by number and name, for an application to read and set.
// Interrupt safe: pure functions. Cost: constant.

#include <cstdint>

#include "tactree/core/configuration/configuration.hpp"

namespace tactree::core {

inline constexpr std::uint32_t kParameters = 30;

struct Parameter {
  const char* name = "";  ///< as in Configuration: "device.home_position[0]"
  float min = 0.0F;
  float max = 0.0F;
};

/// Precondition of all: number < kParameters. Some ranges also depend on other values: call
/// check(Configuration) afterwards.
[[nodiscard]] Parameter parameter(std::uint32_t number);
[[nodiscard]] float parameter_of(const Configuration& configuration, std::uint32_t number);
/// False: not finite or out of range; nothing changed. A home_count is rounded towards 0.
[[nodiscard]] bool set_parameter(Configuration& configuration, std::uint32_t number, float value);

}  // namespace tactree::core
