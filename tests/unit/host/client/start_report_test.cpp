// The report of a board's start as text.

#include "tactree/client/start_report.hpp"

#include <gtest/gtest.h>

#include <set>

#include "tactree/core/model/blob.hpp"

namespace tactree::test {
namespace {

using client::complaints;
using core::wire::StartPart;

bool has(const std::vector<std::string>& all, const std::string& words) {
  return all.size() == 1U && all.front().find(words) != std::string::npos;
}

TEST(StartReport, IsEmptyWithoutFailures) { EXPECT_TRUE(complaints({}).empty()); }

TEST(StartReport, NamesEachMissingPart) {
  std::set<std::string> different;
  for (const StartPart part : {StartPart::kEncoders, StartPart::kMotors, StartPart::kEnableLine,
                               StartPart::kSafetyInputs, StartPart::kWatchdog, StartPart::kReceiver,
                               StartPart::kUsb, StartPart::kCrystal, StartPart::kCrystalFrequency,
                               StartPart::kWaitStates, StartPart::kPll, StartPart::kClockSwitch}) {
    core::wire::ReadStartReply start;
    start.missing = static_cast<std::uint32_t>(part);
    const auto all = complaints(start);
    EXPECT_TRUE(has(all, "motors disabled"));
    EXPECT_FALSE(has(all, "does not know")) << start.missing;
    different.insert(all.front());
  }
  EXPECT_EQ(different.size(), 12U);
  core::wire::ReadStartReply start;
  start.missing = 1U << 31U;
  EXPECT_TRUE(has(complaints(start), "does not know"));
}

TEST(StartReport, ReportsWhyModelIsMissing) {
  core::wire::ReadStartReply start;
  start.model = 1;
  EXPECT_TRUE(has(complaints(start), "its model cannot be used"));
  start.blob = static_cast<std::uint8_t>(core::BlobStatus::kBadChecksum);
  EXPECT_TRUE(has(complaints(start), core::describe(core::BlobStatus::kBadChecksum)));
  start.configuration = 1;
  EXPECT_TRUE(has(complaints(start), "its configuration"));
  start.image = 1;
  EXPECT_TRUE(has(complaints(start), "damaged"));
  start.image = 2;
  EXPECT_TRUE(has(complaints(start), "RAM self-test failed"));
}

TEST(StartReport, ReportsLastResetCause) {
  core::wire::ReadStartReply start;
  start.by_watchdog = 1;
  EXPECT_TRUE(has(complaints(start), "watchdog"));
  start = {};
  start.fault_cause = 3;
  start.fault_pc = 0x0800D123;
  EXPECT_TRUE(has(complaints(start), "exception 3 at 0x0800d123"));
}

}  // namespace
}  // namespace tactree::test
