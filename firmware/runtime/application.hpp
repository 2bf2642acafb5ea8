#pragma once
// What every board that serves an application at a port (hal/session/session.hpp) does alike.

#include <cstdint>

#include "platform.hpp"
#include "tactree/core/parameters.hpp"

namespace tactree::firmware {

/// The core's part of a session.
struct SessionPlatform {
  [[nodiscard]] std::uint32_t now_us() noexcept { return firmware::now_us(); }
  void hold_ticks(bool hold) noexcept { firmware::hold_ticks(hold); }
};

/// The calibration that an application has saved goes before that of the image.
template <class Store>
void take_saved_parameters(const Store& store, core::Configuration& configuration) {
  if (const float* const saved = store.parameters()) {
    for (std::uint32_t i = 0; i < core::kParameters; ++i) {  // bound: kParameters
      (void)core::set_parameter(configuration, i, saved[i]);
    }
  }
}

}  // namespace tactree::firmware
