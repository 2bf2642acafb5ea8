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

/// Sets `adjustment` to the current one with the requested limits. `base`: configuration at the
/// start, whose force and slew limits are the upper bounds. Errors: kBadLength, kBadValue.
[[nodiscard]] core::wire::WireStatus limits_of(std::span<const std::byte> payload,
                                               const core::Controller& controller,
                                               const core::Configuration& base,
                                               core::Adjustment& adjustment);
/// Sets `adjustment` to the current one with the requested material. Errors: kBadLength.
[[nodiscard]] core::wire::WireStatus material_of(std::span<const std::byte> payload,
                                                 const core::Controller& controller,
                                                 core::Adjustment& adjustment);
/// Sets `adjustment` to the current one with the requested texture. Errors: kBadLength.
[[nodiscard]] core::wire::WireStatus texture_of(std::span<const std::byte> payload,
                                                const core::Controller& controller,
                                                core::Adjustment& adjustment);

/// Returns kLater while an update of another body waits for a tick.
[[nodiscard]] Outcome move_body(std::span<const std::byte> payload,
                                const core::Controller& controller, TickMailbox& mailbox,
                                Reply& reply);

/// Errors: kBadLength; kBadValue; kNotNow if the controller is not active.
[[nodiscard]] core::wire::WireStatus add_force(std::span<const std::byte> payload,
                                               const core::Controller& controller,
                                               TickMailbox& mailbox);

}  // namespace tactree::session
