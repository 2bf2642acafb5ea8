#pragma once
// The clock of a session, and the lock between a session and the tick interrupt.

#include <concepts>
#include <cstdint>

namespace tactree::session {

/// Requirements of a session in addition to port and store.
///   now_us()          returns the time of the Ticker, us; wraps at 2^32. Never called while ticks
///                     are held, because the clock may depend on the tick interrupt
///   hold_ticks(hold)  true: no tick starts; false: ticks that became due run immediately. Held
///                     for one call of the controller, at most the time to load a model
template <class T>
concept SessionPlatform = requires(T& platform, bool hold) {
  { platform.now_us() }
  noexcept->std::same_as<std::uint32_t>;
  { platform.hold_ticks(hold) }
  noexcept->std::same_as<void>;
};

}  // namespace tactree::session
