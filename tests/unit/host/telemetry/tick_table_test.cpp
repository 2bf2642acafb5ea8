#include "tactree/telemetry/tick_table.hpp"

#include <gtest/gtest.h>

#include <set>

namespace tactree::telemetry {
namespace {

core::wire::Telemetry message(std::uint32_t tick, std::uint32_t time_us) {
  core::wire::Telemetry telemetry;
  telemetry.header.tick = tick;
  telemetry.header.board_time_us = time_us;
  return telemetry;
}

TEST(TickSequence, CountsMissingTicks) {
  TickSequence sequence;
  EXPECT_EQ(sequence.next(message(5, 5000))->missing_ticks, 0U);
  EXPECT_EQ(sequence.next(message(6, 6000))->missing_ticks, 0U);
  EXPECT_EQ(sequence.next(message(9, 9000))->missing_ticks, 2U);
  EXPECT_EQ(sequence.next(message(10, 10000))->missing_ticks, 0U);
}

TEST(TickSequence, CountsMissingMessagesOfADecimation) {
  TickSequence sequence(10);
  EXPECT_EQ(sequence.next(message(20, 20000))->missing_ticks, 0U);
  EXPECT_EQ(sequence.next(message(30, 30000))->missing_ticks, 0U);
  EXPECT_EQ(sequence.next(message(60, 60000))->missing_ticks, 2U);
}

TEST(TickSequence, ContinuesWhenCountersWrap) {
  TickSequence sequence;
  EXPECT_EQ(sequence.next(message(0xFFFFFFFFU, 0xFFFFFE00U))->time_us, 0U);
  const auto next = sequence.next(message(0, 0x200));
  EXPECT_EQ(next->time_us, 0x400U);
  EXPECT_EQ(next->missing_ticks, 0U);
}

TEST(TickSequence, DropsOldMessages) {
  TickSequence sequence;
  EXPECT_TRUE(sequence.next(message(7, 7000)));
  EXPECT_FALSE(sequence.next(message(7, 7000)));
  EXPECT_FALSE(sequence.next(message(6, 6000)));
  EXPECT_EQ(sequence.next(message(8, 8000))->missing_ticks, 0U);
}

TEST(TickColumns, HaveAValueAndAName) {
  std::vector<double> values;
  values_of({}, values);
  EXPECT_EQ(values.size(), columns().size());
  std::set<std::string> names;
  for (const Column& column : columns()) {
    names.insert(column.name);
  }
  EXPECT_EQ(names.size(), columns().size());
}

}  // namespace
}  // namespace tactree::telemetry
