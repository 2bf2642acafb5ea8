#pragma once
// Calibration values of a Configuration with numbers and names, for access by an application.
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

/// Precondition of all functions: number < kParameters. Some ranges also depend on other values:
/// call check(Configuration) after set_parameter().
[[nodiscard]] Parameter parameter(std::uint32_t number);
[[nodiscard]] float parameter_of(const Configuration& configuration, std::uint32_t number);
/// Returns false and changes nothing if `value` is not finite or out of range. A home_count is
/// rounded towards 0.
[[nodiscard]] bool set_parameter(Configuration& configuration, std::uint32_t number, float value);

}  // namespace tactree::core
