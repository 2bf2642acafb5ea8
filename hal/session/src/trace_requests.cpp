// Loop and memory annotations: docs/BOUND.md.

#include "tactree/session/trace_requests.hpp"

#include <cstdint>

#include "fields.hpp"

namespace tactree::session {

using core::wire::WireStatus;

WireStatus read_trace(std::span<const std::byte> payload, const core::FlightRecorder& recorder,
                      Reply& reply) {
  core::wire::ReadTraceRequest request;
  if (!core::wire::decode_message(payload, request)) {
    return WireStatus::kBadLength;
  }
  if (request.count == 0U || request.count > core::wire::kMaxTraceRecords) {
    return WireStatus::kBadValue;
  }
  const std::uint32_t total = recorder.count();
  const std::uint32_t left = request.age < total ? total - request.age : 0U;
  const std::uint32_t count = left < request.count ? left : request.count;
  reply.put(core::wire::ReadTraceReply{recorder.last_tick(), total, request.age, count});
  for (std::uint32_t i = 0; i < count; ++i) {  // bound: kMaxTraceRecords
    reply.append(std::as_bytes(std::span(&recorder.record(request.age + i), 1)));
  }
  return WireStatus::kOk;
}

void read_fault(const core::FlightRecorder& recorder, Reply& reply) {
  const core::FaultSnapshot& snapshot = recorder.snapshot();
  core::wire::ReadFaultReply message;
  message.faults = snapshot.faults;
  message.tick = snapshot.tick;
  copy(snapshot.probe, message.probe_m);
  copy(snapshot.proxy, message.proxy_m);
  copy(snapshot.velocity, message.velocity_m_s);
  copy(snapshot.force, message.force_N);
  reply.put(message);
}

}  // namespace tactree::session
