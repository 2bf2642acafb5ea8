#include "tactree/telemetry/tick_file.hpp"

#include <gtest/gtest.h>

#include "folder_test.hpp"
#include "message_of.hpp"
#include "tactree/support/csv.hpp"
#include "tactree/support/user_error.hpp"

namespace tactree::telemetry {
namespace {

using support::UserError;

class TickFileTest : public test::FolderTest {};

Tick tick_with_values() {
  Tick tick;
  tick.time_us = 36'000'000'125;
  tick.missing_ticks = 3;
  tick.telemetry.header.tick = 4'000'000'000U;
  tick.telemetry.state = static_cast<std::uint32_t>(core::State::kActive);
  tick.telemetry.body = 2;
  tick.telemetry.force_N[2] = 0.1F;
  return tick;
}

TEST_F(TickFileTest, CsvKeepsEveryValue) {
  const auto path = folder_ / "ticks.csv";
  const auto file = open_tick_file(path);
  const Tick tick = tick_with_values();
  file->append(std::span(&tick, 1));
  EXPECT_FALSE(std::filesystem::exists(path));
  file->finish();
  support::CsvReader table(path, {});
  ASSERT_TRUE(table.next_row());
  const auto number = [&](const char* name) {
    return table.number(table.find_column(name).value());
  };
  EXPECT_EQ(number("t_s"), 36000.000125);
  EXPECT_EQ(number("tick"), 4e9);
  EXPECT_EQ(number("missing_ticks"), 3.0);
  EXPECT_EQ(number("body"), 2.0);
  EXPECT_EQ(static_cast<float>(number("force_z_N")), 0.1F);
  EXPECT_EQ(table.cells()[table.find_column("state").value()], "active");
  EXPECT_FALSE(table.next_row());
}

TEST_F(TickFileTest, HasColumnsOfFieldsOnly) {
  constexpr std::uint32_t kFields = recorded_fields(0);
  const Tick tick = tick_with_values();
  const auto path = folder_ / "older.csv";
  const auto file = open_tick_file(path, kFields);
  file->append(std::span(&tick, 1));
  file->finish();
  support::CsvReader table(path, {});
  EXPECT_EQ(table.columns().size(), columns_of(kFields).size());
  EXPECT_TRUE(table.next_row());
}

TEST_F(TickFileTest, UnfinishedCsvHasIncompleteName) {
  const auto path = folder_ / "ticks.csv";
  const Tick tick = tick_with_values();
  open_tick_file(path)->append(std::span(&tick, 1));
  EXPECT_FALSE(std::filesystem::exists(path));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "ticks.csv.incomplete"));
  EXPECT_NE(test::message_of<UserError>([&] {
              (void)open_tick_file(path);
            }).find("ticks.csv.incomplete: exists"),
            std::string::npos);
}

TEST_F(TickFileTest, RefusesOtherNames) {
  for (const char* name : {"ticks.txt", "ticks", "ticks.rec"}) {
    EXPECT_THROW(check_tick_file(folder_ / name), UserError) << name;
  }
  EXPECT_NE(test::message_of<UserError>([] { check_tick_file("a.rec"); }).find("simulate --record"),
            std::string::npos);
  EXPECT_NO_THROW(check_tick_file("/dev/null"));
  EXPECT_NO_THROW(check_tick_file("/dev/null.csv"));
}

}  // namespace
}  // namespace tactree::telemetry
