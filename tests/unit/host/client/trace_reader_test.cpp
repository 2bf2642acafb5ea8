// The records of a board that goes on recording, more or fewer ticks between two requests.

#include "trace_reader.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <random>

namespace tactree::client {
namespace {

/// Records that are told apart by their load.
struct Recorder {
  std::uint32_t total = 512;
  std::uint32_t last_tick = 5000;
  std::function<std::uint32_t()> growth = [] { return 0U; };  // ticks before each reply
  int requests = 0;

  TraceReply operator()(const core::wire::ReadTraceRequest& request) {
    ++requests;
    last_tick += growth();
    TraceReply reply;
    reply.header = {last_tick, total, request.age,
                    std::min(request.count, total - std::min(total, request.age))};
    for (std::uint32_t i = 0; i < reply.header.count; ++i) {
      core::FlightRecord record;
      record.load = static_cast<decltype(record.load)>((last_tick - request.age - i) % 251U);
      reply.records.push_back(record);
    }
    return reply;
  }
};

/// Reads a trace whose ticks must be consecutive up to the newest of the first reply.
std::vector<TracedTick> consecutive(Recorder& recorder) {
  const std::uint32_t before = recorder.last_tick;
  std::uint32_t first = 0;
  const auto trace = read_trace([&](const core::wire::ReadTraceRequest& request) {
    TraceReply reply = recorder(request);
    first = recorder.requests == 1 ? recorder.last_tick : first;
    return reply;
  });
  EXPECT_GE(first, before);
  for (std::size_t i = 0; i < trace.size(); ++i) {
    const std::uint32_t tick = first - static_cast<std::uint32_t>(trace.size() - 1U - i);
    EXPECT_EQ(trace[i].tick, tick);
    EXPECT_EQ(trace[i].record.load, tick % 251U);
  }
  return trace;
}

TEST(TraceReader, ReadsAllOfABoardThatStandsStill) {
  Recorder recorder;
  EXPECT_EQ(consecutive(recorder).size(), 512U);
  EXPECT_LE(recorder.requests, 40);
}

TEST(TraceReader, LeavesNoGapAtAnyGrowth) {
  for (const std::uint32_t growth : {1U, 5U, 12U, 13U, 14U, 40U, 200U}) {
    Recorder recorder;
    recorder.total = 8192;
    recorder.growth = [growth] { return growth; };
    EXPECT_GE(consecutive(recorder).size(), growth < 20U ? 2500U : 200U) << growth;
  }
}

TEST(TraceReader, LeavesNoGapAtRandomGrowth) {
  std::mt19937 random(3);
  Recorder recorder;
  recorder.total = 8192;
  recorder.growth = [&] {
    return static_cast<std::uint32_t>(random() % 10U == 0U ? 90 : random() % 9U);
  };
  EXPECT_GE(consecutive(recorder).size(), 2000U);
}

TEST(TraceReader, EndsIfTheBoardRecordsFasterThanItReads) {
  Recorder recorder;
  recorder.total = 8192;
  std::uint32_t growth = 20;
  recorder.growth = [&] { return growth = growth * 5U % 8191U; };
  EXPECT_GE(consecutive(recorder).size(), 13U);
  EXPECT_LE(recorder.requests, 3000);
}

TEST(TraceReader, ReadsShortAndEmptyTraces) {
  for (const std::uint32_t total : {0U, 1U, 13U, 14U}) {
    Recorder recorder;
    recorder.total = total;
    EXPECT_EQ(consecutive(recorder).size(), total);
  }
}

TEST(TraceReader, ReadsAcrossTheWrapOfTheTick) {
  Recorder recorder;
  recorder.last_tick = 100;
  recorder.growth = [] { return 3U; };
  const std::vector<TracedTick> trace = read_trace(std::ref(recorder));
  ASSERT_GT(trace.size(), 200U);
  EXPECT_EQ(trace.back().tick, 103U);
  EXPECT_EQ(trace.front().tick, 103U - static_cast<std::uint32_t>(trace.size() - 1U));
}

}  // namespace
}  // namespace tactree::client
