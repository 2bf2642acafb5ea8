#pragma once
// The clock of a session, and the lock between a session and the tick interrupt.

#include <concepts>
#include <cstdint>

namespace tactree::session {

/// Requirements of a session beyond port and store.
///   now_us()          the Ticker's clock, microseconds, wraps at 2^32
///   hold_ticks(hold)  while held no tick begins; ticks that fall due run right after the release.
///                     Held for one controller call, at most the time to load a model.
template <class T>
concept SessionPlatform = requires(T& platform, bool hold) {
  { platform.now_us() }
  noexcept->std::same_as<std::uint32_t>;
  { platform.hold_ticks(hold) }
  noexcept->std::same_as<void>;
};

}  // namespace tactree::session
