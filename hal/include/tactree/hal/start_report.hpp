#pragma once
// Diagnostics of a board's start in addition to StartResult (start_result.hpp), reported over its
// link.

#include <cstdint>

#include "tactree/core/link/wire/messages.hpp"
#include "tactree/hal/captured_fault.hpp"

namespace tactree::hal {

struct StartReport {
  std::uint32_t missing = 0;  ///< parts that did not start: bits of core::wire::StartPart
  bool by_watchdog = false;   ///< the watchdog caused the last reset
  CapturedFault last_fault{};

  void miss(core::wire::StartPart part) { missing |= static_cast<std::uint32_t>(part); }
};

}  // namespace tactree::hal
