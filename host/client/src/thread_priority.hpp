#pragma once
// The priority of the thread that keeps the link to a board alive.

namespace tactree::client {

/// Gives the calling thread a real-time priority, above all programs without one, if the system
/// allows it to this user (limit `ulimit -r` of at least kLinkPriority, or root). Returns false if
/// not: the thread then keeps its priority.
bool prefer_this_thread();

/// Low among real-time priorities: only ordinary programs must not delay a heartbeat.
inline constexpr int kLinkPriority = 10;

}  // namespace tactree::client
