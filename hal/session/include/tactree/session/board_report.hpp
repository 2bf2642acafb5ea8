#pragma once
// Replies that describe a board: identity, start, capabilities, state. Not interrupt safe: called
// between ticks only. Cost of each function: constant.

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
  std::uint32_t cycles_per_second = 0;  ///< clock frequency of the core, Hz; 0: unknown
};

/// Properties of a model store that are reported to a host.
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

/// Converts `age_us`, the time since the board time in a HeartbeatRequest, to ticks. The result is
/// rounded up, plus two: one tick passes until the controller receives the heartbeat, and the
/// controller still accepts a link whose age equals its timeout. Returns false if the board time is
/// in the future, or so old that its age does not fit.
[[nodiscard]] bool link_age(std::uint32_t age_us, float rate_hz, std::uint16_t& ticks);

}  // namespace tactree::session
