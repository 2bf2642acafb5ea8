#pragma once
// The platform of a session (tactree/session/platform.hpp) on all cores.

#include <cstdint>

#include "platform.hpp"

namespace tactree::firmware {

/// The functions of a session that depend on the core.
struct SessionPlatform {
  [[nodiscard]] std::uint32_t now_us() noexcept { return firmware::now_us(); }
  void hold_ticks(bool hold) noexcept { firmware::hold_ticks(hold); }
};

}  // namespace tactree::firmware
