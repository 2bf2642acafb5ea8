#include "tactree/telemetry/tick_table.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <set>
#include <span>

#include "tactree/core/link/wire/frame.hpp"

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

TEST(TickSequence, CountsMissingDecimatedMessages) {
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

std::set<std::string> names_of(const std::vector<Column>& columns) {
  std::set<std::string> names;
  for (const Column& column : columns) {
    names.insert(column.name);
  }
  return names;
}

TEST(TickColumns, HaveValueAndName) {
  std::vector<double> values;
  values_of({}, values);
  EXPECT_EQ(values.size(), columns().size());
  EXPECT_EQ(names_of(columns()).size(), columns().size());
}

// Zeros would look like measured forces.
TEST(TickColumns, OmitForcesMissingFromOlderBoards) {
  constexpr std::uint32_t kFields = recorded_fields(0);
  const std::set<std::string> names = names_of(columns_of(kFields));
  EXPECT_EQ(names.size() + 9, columns().size());
  EXPECT_FALSE(names.contains("motor_force_x_N"));
  EXPECT_TRUE(names.contains("wanted_force_x_N"));
  Tick tick;
  tick.telemetry.header.fields = kFields;
  std::vector<double> values;
  values_of(tick, values, kFields);
  EXPECT_EQ(values.size(), names.size());
  values_of(tick, values);
  for (std::size_t i = 0; i < values.size(); ++i) {
    EXPECT_EQ(std::isnan(values[i]), !names.contains(columns()[i].name)) << columns()[i].name;
  }
}

TEST(FrameBytes, EqualEncodedFrame) {
  for (const std::uint32_t fields : {kRecordedFields, core::wire::kAllTelemetry, 1U}) {
    core::wire::Telemetry telemetry;
    telemetry.header.fields = fields;
    std::array<std::byte, core::wire::kMaxTelemetry> payload{};
    const std::size_t size = core::wire::encode_telemetry(telemetry, payload);
    std::array<std::byte, core::wire::kMaxEncodedFrame> frame{};
    EXPECT_EQ(frame_bytes(fields),
              core::wire::encode_frame({}, std::span(payload).first(size), frame))
        << fields;
  }
}

}  // namespace
}  // namespace tactree::telemetry
