#pragma once
// What a board reports about itself: identity, start, capabilities, state.
// Not interrupt safe: called between ticks only. Cost of each function: constant.

#include <cstdint>

#include "tactree/core/control/controller.hpp"
#include "tactree/hal/loop.hpp"
#include "tactree/hal/start_report.hpp"
#include "tactree/session/reply.hpp"

namespace tactree::session {

struct BoardIdentity {
  const char* board = "";     ///< name; at most 23 characters are sent
  const char* firmware = "";  ///< version; at most 23 characters are sent
  std::uint32_t serial[3] = {0, 0, 0};
  std::uint32_t cycles_per_second = 0;  ///< of the core's clock; 0: not known
};

/// Properties of a model store that a host may ask for.
struct StoreFacts {
  std::uint32_t slots = 0;
  std::uint32_t slot_bytes = 0;
  bool signature_required = false;
};

void put_identity(const BoardIdentity& identity, Reply& reply);

void put_start(const hal::StartResult& start, const hal::StartReport& report, Reply& reply);

/// `base`: the configuration at the start.
void put_capabilities(const core::Controller& controller, const core::Configuration& base,
                      const StoreFacts& store, std::uint32_t cycles_per_second, Reply& reply);

void put_state(const core::Status& status, const hal::StartResult& start, std::uint32_t now_us,
               Reply& reply);

/// For HeartbeatRequest: now_us minus the board time that the host has seen, in ticks, rounded up,
/// plus two: the next tick takes it, and the controller accepts a link as old as its timeout.
/// False: the time lies in the future, or so far in the past that it proves nothing.
[[nodiscard]] bool link_age(std::uint32_t age_us, float rate_hz, std::uint16_t& ticks);

}  // namespace tactree::session
