#pragma once
// Reads the flight recorder: its records, and the tick in which the first fault was latched.
// Precondition of both functions: ticks are held, because they write the recorder.

#include <cstddef>
#include <span>

#include "tactree/core/control/flight_recorder.hpp"
#include "tactree/core/link/wire/messages.hpp"
#include "tactree/session/reply.hpp"

namespace tactree::session {

/// Errors: kBadLength, kBadValue. Cost: copies at most kMaxTraceRecords records.
[[nodiscard]] core::wire::WireStatus read_trace(std::span<const std::byte> payload,
                                                const core::FlightRecorder& recorder, Reply& reply);

/// Cost: constant.
void read_fault(const core::FlightRecorder& recorder, Reply& reply);

}  // namespace tactree::session
