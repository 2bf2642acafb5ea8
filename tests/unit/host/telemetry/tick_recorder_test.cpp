#include "tactree/telemetry/tick_recorder.hpp"

#include <gtest/gtest.h>

#include "folder_test.hpp"
#include "tactree/support/csv.hpp"

namespace tactree::telemetry {
namespace {

class TickRecorderTest : public test::FolderTest {
 protected:
  /// Message of a board at 1 kHz that has omitted `dropped` ones since the subscription.
  static core::wire::Telemetry message(std::uint32_t tick, std::uint32_t dropped = 0) {
    core::wire::Telemetry telemetry;
    telemetry.header = {tick, 1000U * tick, kRecordedFields, dropped};
    return telemetry;
  }
  [[nodiscard]] std::vector<double> column(const char* name) const {
    support::CsvReader table(file_, {});
    std::vector<double> values;
    while (table.next_row()) {
      values.push_back(table.number(table.find_column(name).value()));
    }
    return values;
  }

  std::filesystem::path file_ = folder_ / "ticks.csv";
};

TEST_F(TickRecorderTest, CountsGapsAndOmittedTicks) {
  TickRecorder recorder(file_, {});
  // The board omitted seven ticks before the first row, then 12 and 13; 16 was lost on the way.
  const std::vector<core::wire::Telemetry> first = {message(10, 7), message(11, 7), message(14, 9)};
  EXPECT_TRUE(recorder.add(first));
  const std::vector<core::wire::Telemetry> second = {message(15, 9), message(17, 9)};
  EXPECT_TRUE(recorder.add(second));
  recorder.finish();
  EXPECT_EQ(recorder.counts().rows, 5U);
  EXPECT_EQ(recorder.counts().missing, 3U);
  EXPECT_EQ(recorder.counts().gaps, 2U);
  EXPECT_EQ(recorder.counts().omitted, 2U);
  EXPECT_EQ(summary_of(recorder.counts()),
            "5 ticks in 0.007 s, 3 missing in 2 gaps, 2 of them omitted by the board");
  EXPECT_EQ(column("missing_ticks"), (std::vector<double>{0, 0, 2, 0, 1}));
}

TEST_F(TickRecorderTest, CountsMissingDecimatedMessages) {
  TickRecorder recorder(file_, {.every_ticks = 10});
  const std::vector<core::wire::Telemetry> messages = {message(10), message(20), message(50)};
  EXPECT_TRUE(recorder.add(messages));
  EXPECT_EQ(summary_of(recorder.counts()),
            "3 ticks in 0.040 s, 2 missing in 1 gaps (one tick of 10)");
}

TEST_F(TickRecorderTest, EndsAfterDurationOnBoardClock) {
  TickRecorder recorder(file_, {.seconds = 0.003});
  const std::vector<core::wire::Telemetry> messages = {message(1), message(2), message(3),
                                                       message(4), message(5)};
  EXPECT_FALSE(recorder.add(messages));
  recorder.finish();
  EXPECT_EQ(column("tick"), (std::vector<double>{1, 2, 3}));
  EXPECT_EQ(summary_of(recorder.counts()), "3 ticks in 0.002 s, none missing");
}

TEST_F(TickRecorderTest, IgnoresOldMessages) {
  TickRecorder recorder(file_, {});
  const std::vector<core::wire::Telemetry> messages = {message(2), message(2), message(1),
                                                       message(3)};
  EXPECT_TRUE(recorder.add(messages));
  EXPECT_TRUE(recorder.add({}));
  recorder.finish();
  EXPECT_EQ(column("tick"), (std::vector<double>{2, 3}));
  EXPECT_EQ(recorder.counts().missing, 0U);
}

}  // namespace
}  // namespace tactree::telemetry
