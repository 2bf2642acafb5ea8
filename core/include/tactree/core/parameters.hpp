#pragma once
// The figures of a Configuration that calibrate a device, by number and name, for an application to
// read and set. Interrupt safe: pure functions.

#include <cstdint>

#include "tactree/core/configuration.hpp"

namespace tactree::core {

inline constexpr std::uint32_t kParameters = 30;

struct Parameter {
  const char* name = "";  ///< as in Configuration: "device.home_position[0]"
  float min = 0.0F;
  float max = 0.0F;
};

/// Precondition of all: number < kParameters. Some ranges depend on other figures as well:
/// check(Configuration) has the last word.
[[nodiscard]] Parameter parameter(std::uint32_t number);
[[nodiscard]] float parameter_of(const Configuration& configuration, std::uint32_t number);
/// False: not finite, or out of the range; nothing was changed. A home_count is rounded towards 0.
[[nodiscard]] bool set_parameter(Configuration& configuration, std::uint32_t number, float value);

}  // namespace tactree::core
