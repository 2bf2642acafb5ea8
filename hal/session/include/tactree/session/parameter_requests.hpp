#pragma once
// Reads and sets calibration parameters by number. ModelTransfer stores them (kSaveParameters). Not
// interrupt safe: called between ticks only. Cost of each function: constant.

#include <cstddef>
#include <span>

#include "tactree/core/control/controller.hpp"
#include "tactree/core/link/wire/messages.hpp"
#include "tactree/session/reply.hpp"

namespace tactree::session {

/// Errors: kBadLength, kBadValue.
[[nodiscard]] core::wire::WireStatus get_parameter(std::span<const std::byte> payload,
                                                   const core::Controller& controller,
                                                   Reply& reply);

/// Sets `changed` to the current configuration with the requested parameter. Errors: kBadLength;
/// kBusy if armed or active; kBadValue.
[[nodiscard]] core::wire::WireStatus parameter_change(std::span<const std::byte> payload,
                                                      const core::Controller& controller,
                                                      core::wire::SetParameterRequest& request,
                                                      core::Configuration& changed);

/// Precondition: number < kParameters.
void put_parameter(std::uint32_t number, const core::Controller& controller, Reply& reply);

}  // namespace tactree::session
