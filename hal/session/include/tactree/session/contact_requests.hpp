#pragma once
// Requests that change the rendered contact: force limits, material, bodies, application forces.
// Not interrupt safe: called between ticks only. Cost of each function: constant.

#include <cstddef>
#include <span>

#include "tactree/core/control/controller.hpp"
#include "tactree/core/link/wire/messages.hpp"
#include "tactree/session/reply.hpp"
#include "tactree/session/tick_mailbox.hpp"

namespace tactree::session {

// Precondition of these two: ticks are held. `base`: the configuration at the start, whose force
// and slew limits are the upper bounds.
// kBadLength, kBadValue, kUnstable; kBusy: while armed or active limits cannot change.
[[nodiscard]] core::wire::WireStatus set_limits(std::span<const std::byte> payload,
                                                core::Controller& controller,
                                                const core::Configuration& base);
[[nodiscard]] core::wire::WireStatus set_material(std::span<const std::byte> payload,
                                                  core::Controller& controller);

/// kLater: a move of another body has not been taken by a tick yet.
[[nodiscard]] Outcome move_body(std::span<const std::byte> payload,
                                const core::Controller& controller, TickMailbox& mailbox,
                                Reply& reply);

/// kBadLength, kBadValue; kNotNow: the controller is not active.
[[nodiscard]] core::wire::WireStatus add_force(std::span<const std::byte> payload,
                                               const core::Controller& controller,
                                               TickMailbox& mailbox);

}  // namespace tactree::session
