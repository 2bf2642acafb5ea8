#pragma once
// Reads the records of a board that records further ones meanwhile.

#include <cstdint>
#include <functional>
#include <vector>

#include "tactree/client/board.hpp"
#include "tactree/core/link/wire/messages.hpp"

namespace tactree::client {

struct TraceReply {
  core::wire::ReadTraceReply header{};
  std::vector<core::FlightRecord> records;  // header.count, the newest first
};

using ReadTrace = std::function<TraceReply(const core::wire::ReadTraceRequest&)>;

/// Returns consecutive ticks, oldest first, up to the newest of the first reply.
[[nodiscard]] std::vector<TracedTick> read_trace(const ReadTrace& read);

}  // namespace tactree::client
