#include "edge_order.hpp"

#include <gtest/gtest.h>

namespace tactree::hal::linux_gpio {
namespace {

constexpr std::uint64_t kTick_ns = 1'000'000;

/// Two lines; each look finds the interrupts and edges given so far.
class EdgesOfTwoQueues : public testing::Test {
 protected:
  EdgesOfTwoQueues() { order_.begin({100, 7}); }

  /// `handled`: edges that reach their queue before this look.
  std::vector<Edge> look(std::uint64_t time_ns, const std::vector<std::uint32_t>& interrupts,
                         const std::vector<Edge>& handled) {
    order_.look(time_ns, time_ns, {100 + interrupts[0], 7 + interrupts[1]});
    for (const Edge& edge : handled) {
      order_.add(edge);
    }
    order_.settle();
    std::vector<Edge> taken;
    Edge edge;
    while (order_.take(edge)) {
      taken.push_back(edge);
    }
    return taken;
  }
  static std::vector<std::uint64_t> times(const std::vector<Edge>& edges) {
    std::vector<std::uint64_t> result;
    for (const Edge& edge : edges) {
      result.push_back(edge.time_ns);
    }
    return result;
  }
  using Times = std::vector<std::uint64_t>;

  EdgeOrder order_{2};
};

TEST_F(EdgesOfTwoQueues, SortsByTime) {
  const auto edges =
      look(50, {2, 2}, {{10, 0, true}, {30, 0, false}, {20, 1, true}, {40, 1, false}});
  EXPECT_EQ(times(edges), (Times{10, 20, 30, 40}));
  EXPECT_EQ(order_.lost(), 0U);
}

TEST_F(EdgesOfTwoQueues, DefersEdgesAfterLook) {
  EXPECT_EQ(times(look(15, {1, 0}, {{10, 0, true}, {20, 1, true}})), (Times{10}));
  EXPECT_EQ(times(look(50, {2, 1}, {{18, 0, false}})), (Times{18, 20}));
  EXPECT_EQ(order_.lost(), 0U);
}

TEST_F(EdgesOfTwoQueues, WaitsForOneInFlight) {
  EXPECT_EQ(times(look(50, {1, 1}, {{20, 1, true}})), Times{}) << "line 0 had an interrupt before";
  EXPECT_EQ(times(look(60, {1, 1}, {{10, 0, true}})), (Times{10, 20}));
  EXPECT_EQ(order_.lost(), 0U);
}

/// The wait for one edge hides no other that is in flight when it arrives.
TEST_F(EdgesOfTwoQueues, WaitsForAllInFlight) {
  EXPECT_EQ(times(look(15, {1, 0}, {})), Times{});
  EXPECT_EQ(times(look(50, {2, 1}, {{10, 0, true}, {40, 1, true}})), (Times{10}));
  EXPECT_EQ(times(look(60, {2, 1}, {})), Times{});
  EXPECT_EQ(times(look(70, {2, 1}, {{30, 0, false}})), (Times{30, 40}));
  EXPECT_EQ(order_.lost(), 0U);
}

/// A loop in step with the device: at each look an edge is in flight, of either line in turn.
TEST_F(EdgesOfTwoQueues, ProceedsDespiteLinesInFlight) {
  std::vector<std::uint32_t> interrupts = {0, 0};
  std::vector<Edge> in_flight;
  for (std::uint32_t tick = 1; tick < 20; ++tick) {
    const std::uint32_t line = tick % 2U;
    ++interrupts[line];
    EXPECT_EQ(times(look(tick * kTick_ns, interrupts, in_flight)), times(in_flight)) << tick;
    in_flight = {{tick * kTick_ns - 5, line, tick % 4U < 2U}};
  }
  EXPECT_EQ(order_.lost(), 0U);
}

/// The same of one line: it is checked at each look, not at every other one.
TEST_F(EdgesOfTwoQueues, WaitsForOneLookOnly) {
  EXPECT_EQ(times(look(kTick_ns, {1, 0}, {})), Times{});
  EXPECT_EQ(times(look(2 * kTick_ns, {2, 1}, {{5, 0, true}, {kTick_ns + 5, 1, true}})), (Times{5}));
  EXPECT_EQ(times(look(3 * kTick_ns, {3, 1}, {{2 * kTick_ns - 5, 0, false}})),
            (Times{kTick_ns + 5, 2 * kTick_ns - 5}));
  EXPECT_EQ(order_.lost(), 0U);
}

TEST_F(EdgesOfTwoQueues, HoldsUntilOrderIsCertain) {
  EXPECT_EQ(order_.held(), 0U);
  EXPECT_EQ(times(look(50, {1, 1}, {{20, 1, true}})), Times{});
  EXPECT_EQ(order_.held(), 2U) << "that of line 1";
  EXPECT_EQ(times(look(60, {1, 1}, {{10, 0, true}})), (Times{10, 20}));
  EXPECT_EQ(order_.held(), 0U);
}

TEST_F(EdgesOfTwoQueues, CountsLateEdgesAsLost) {
  EXPECT_EQ(times(look(1, {3, 0}, {{1, 0, true}})), Times{});
  EXPECT_EQ(times(look(kTick_ns, {3, 0}, {})), Times{});
  EXPECT_EQ(order_.lost(), 0U);
  EXPECT_EQ(times(look(2 * kTick_ns + 1, {3, 0}, {})), (Times{1}));
  EXPECT_EQ(order_.lost(), 2U);
  EXPECT_EQ(times(look(3 * kTick_ns, {4, 0}, {{3 * kTick_ns - 9, 0, false}})),
            (Times{3 * kTick_ns - 9}));
  EXPECT_EQ(order_.lost(), 2U) << "the later ones are counted from there";
}

/// The line is never at rest.
TEST_F(EdgesOfTwoQueues, CountsMissedEdgesInStream) {
  std::uint32_t interrupts = 2;  // of one edge
  (void)look(1, {interrupts, 0}, {{1, 0, true}});
  for (std::uint64_t tick = 1; tick < 10; ++tick) {
    ++interrupts;
    (void)look(tick * kTick_ns, {interrupts, 0}, {{tick * kTick_ns - 1, 0, tick % 2 == 0}});
  }
  EXPECT_EQ(order_.lost(), 1U);
}

TEST_F(EdgesOfTwoQueues, CountsOverflowAsLost) {
  order_.overflowed();
  EXPECT_EQ(order_.lost(), 1U);
}

TEST_F(EdgesOfTwoQueues, LosesEdgesBeyondRoom) {
  std::vector<Edge> many;
  for (std::uint64_t i = 0; i <= EdgeOrder::kHeld; ++i) {
    many.push_back({i, 0, i % 2 == 0});
  }
  (void)look(1000, {EdgeOrder::kHeld + 1, 1}, many);
  EXPECT_EQ(order_.lost(), 1U);
}

}  // namespace
}  // namespace tactree::hal::linux_gpio
