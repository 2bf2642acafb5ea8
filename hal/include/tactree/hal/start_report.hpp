#pragma once
// Diagnostics of the start of a board beyond StartResult (loop.hpp), reported over its link.

#include <cstdint>

#include "tactree/core/link/wire/messages.hpp"
#include "tactree/hal/captured_fault.hpp"

namespace tactree::hal {

struct StartReport {
  std::uint32_t missing = 0;  ///< bit set of core::wire::StartPart
  bool by_watchdog = false;   ///< the watchdog caused the last reset
  CapturedFault last_fault{};

  void miss(core::wire::StartPart part) { missing |= static_cast<std::uint32_t>(part); }
};

}  // namespace tactree::hal
