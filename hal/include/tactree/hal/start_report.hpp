#pragma once
// How a board came up, beyond StartResult (loop.hpp): for people, told over its link.

#include <cstdint>

#include "tactree/core/wire/messages.hpp"
#include "tactree/hal/captured_fault.hpp"

namespace tactree::hal {

struct StartReport {
  std::uint32_t missing = 0;  ///< core::wire::StartPart, or of them
  bool by_watchdog = false;   ///< the watchdog caused the last reset
  CapturedFault last_fault{};

  void miss(core::wire::StartPart part) { missing |= static_cast<std::uint32_t>(part); }
};

}  // namespace tactree::hal
