#pragma once
// Device calibration by number: read and set. Values are kept by ModelTransfer (kSaveParameters).
// Not interrupt safe: called between ticks only. Cost of each function: constant.

#include <cstddef>
#include <span>

#include "tactree/core/control/controller.hpp"
#include "tactree/core/link/wire/messages.hpp"
#include "tactree/session/reply.hpp"

namespace tactree::session {

/// kBadLength, kBadValue.
[[nodiscard]] core::wire::WireStatus get_parameter(std::span<const std::byte> payload,
                                                   const core::Controller& controller,
                                                   Reply& reply);

/// Configures the controller with the changed value: the device has to be homed again, and its
/// models are checked again. Precondition: ticks are held.
/// kBadLength, kBadValue, kUnstable; kBusy: armed or active.
[[nodiscard]] core::wire::WireStatus set_parameter(std::span<const std::byte> payload,
                                                   core::Controller& controller, Reply& reply);

}  // namespace tactree::session
