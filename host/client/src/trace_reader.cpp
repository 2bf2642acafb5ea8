#include "trace_reader.hpp"

#include <algorithm>
#include <map>

namespace tactree::client {
namespace {

constexpr std::uint32_t kRecords = core::wire::kMaxTraceRecords;

}  // namespace

std::vector<TracedTick> read_trace(const ReadTrace& read) {
  TraceReply reply = read({0, kRecords});
  const std::uint32_t newest = reply.header.last_tick;
  std::map<std::uint32_t, core::FlightRecord> records;  // by ticks before `newest`
  std::uint32_t next = 0;                               // the first that is missing
  std::uint32_t grown = 0;  // ticks that the board recorded after `newest`
  const std::uint32_t most = 16U + 4U * (reply.header.total / kRecords);
  for (std::uint32_t requests = 1;; ++requests) {
    const core::wire::ReadTraceReply& header = reply.header;
    const std::uint32_t growth = header.last_tick - newest - grown;
    grown += growth;
    for (std::uint32_t i = 0; i < reply.records.size(); ++i) {
      if (header.age + i >= grown) {
        records.emplace(header.age + i - grown, reply.records[i]);
      }
    }
    while (records.contains(next)) {
      ++next;
    }
    if (next + grown >= header.total || requests == most) {
      break;
    }
    // The ages grow until the board answers, by about as much as before: the reply then has the
    // missing record in its middle.
    const std::uint32_t age = next + grown + growth - std::min(growth, kRecords / 2U);
    reply = read({std::min(age, header.total - 1U), kRecords});
  }
  std::vector<TracedTick> ticks;
  for (std::uint32_t back = next; back > 0U; --back) {
    ticks.push_back({newest - (back - 1U), records.at(back - 1U)});
  }
  return ticks;
}

}  // namespace tactree::client
