// A recording has the numbers of the session: every value of every tick, as the controller gave it.

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <mutex>

#include "folder_test.hpp"
#include "running_board.hpp"
#include "tactree/client/board.hpp"
#include "tactree/support/csv.hpp"
#include "tactree/telemetry/tick_recorder.hpp"

namespace tactree::test {
namespace {

using telemetry::Column;
using telemetry::kRecordedFields;

/// The ticks of a board, by their numbers.
class Ticks {
 public:
  void add(const core::Status& status) {
    const std::lock_guard lock(mutex_);
    statuses_[status.tick] = status;
  }
  [[nodiscard]] const core::Status& at(std::uint32_t tick) const { return statuses_.at(tick); }

 private:
  std::mutex mutex_;
  std::map<std::uint32_t, core::Status> statuses_;
};

class RecordedSessionTest : public FolderTest {
 protected:
  /// Records 1.5 s of a board whose hand presses on the model.
  telemetry::RecordingCounts record() {
    RunningBoard running(0.0295, true,
                         [this](const simulation::Sample& sample) { ticks_.add(sample.status); });
    client::Board board(running.port(), {.link_timeout_ms = 100, .stream_capacity = 65536});
    telemetry::TickRecorder recorder(file_, {.seconds = 1.5});
    board.subscribe({kRecordedFields, 1});
    board.arm();
    while (recorder.add(board.take_stream())) {
      board.connection().sleep(std::chrono::milliseconds(10));
    }
    recorder.finish();
    return recorder.counts();
  }
  /// The values of a tick, as the controller gave them.
  [[nodiscard]] std::vector<double> expected(std::uint32_t tick) const {
    telemetry::Tick row;
    row.telemetry = core::wire::to_telemetry({tick, 0, kRecordedFields, 0}, ticks_.at(tick));
    std::vector<double> values;
    telemetry::values_of(row, values);
    return values;
  }

  std::filesystem::path file_ = folder_ / "session.csv";
  Ticks ticks_;
};

/// The value of a cell, in the type of its column.
double value_of(const Column& column, std::string_view cell) {
  if (!column.words.empty()) {
    const auto word = std::find(column.words.begin(), column.words.end(), cell);
    return static_cast<double>(word - column.words.begin());
  }
  const double value = std::stod(std::string(cell));
  return column.type == telemetry::ColumnType::kFloat32
             ? static_cast<double>(static_cast<float>(value))
             : value;
}

TEST_F(RecordedSessionTest, HasEveryTickAndValue) {
  const telemetry::RecordingCounts counts = record();
  EXPECT_EQ(telemetry::summary_of(counts), "1500 ticks in 1.499 s, none missing");
  support::CsvReader table(file_, {});
  const std::vector<Column>& columns = telemetry::columns();
  ASSERT_EQ(table.columns().size(), columns.size());
  const std::size_t tick_column = table.find_column("tick").value();
  const std::size_t force_column = table.find_column("force_z_N").value();
  double force_max_N = 0.0;
  std::uint32_t before = 0;
  while (table.next_row()) {
    const auto tick = static_cast<std::uint32_t>(table.number(tick_column));
    ASSERT_TRUE(before == 0U || tick == before + 1U) << tick;
    before = tick;
    force_max_N = std::max(force_max_N, table.number(force_column));
    const std::vector<double> values = expected(tick);
    for (std::size_t i = 1; i < columns.size(); ++i) {  // the first is t_s
      ASSERT_EQ(value_of(columns[i], table.cells()[i]), values[i])
          << columns[i].name << " of tick " << tick;
    }
  }
  EXPECT_GT(force_max_N, 0.1);
}

}  // namespace
}  // namespace tactree::test
