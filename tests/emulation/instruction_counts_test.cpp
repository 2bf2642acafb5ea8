#include "tactree/emulation/instruction_counts.hpp"

#include <gtest/gtest.h>

#include "tactree/emulation/emulation_error.hpp"

namespace tactree::test {
namespace {

using emulation::parse_instruction_counts;

TEST(InstructionCounts, ReadsReport) {
  const emulation::InstructionCounts counts = parse_instruction_counts(
      "ticks 4 30 100 77 5000\n"
      "worst 3\n"
      "bucket 0 3\n"
      "bucket 256 1\n"
      "function 10 40 memcpy\n"
      "function 20 60 _ZN7tactree4core5crc32ESt4spanIKSt4byteLj4294967295EE\n"
      "code 800 81c\n"
      "code 820 822\n"
      "end\n");
  EXPECT_EQ(counts.ticks, 4U);
  EXPECT_EQ(counts.max, 30U);
  EXPECT_EQ(counts.mean(), 25.0);
  EXPECT_EQ(counts.checksum, 77U);
  EXPECT_EQ(counts.worst_tick, 3U);
  EXPECT_EQ(counts.start, 5000U);
  ASSERT_EQ(counts.buckets.size(), 2U);
  EXPECT_EQ(counts.buckets[1].fewest, 256U);
  EXPECT_EQ(counts.buckets[1].ticks, 1U);
  ASSERT_EQ(counts.functions.size(), 2U);
  EXPECT_EQ(counts.functions[0].name.substr(0, 20), "tactree::core::crc32");
  EXPECT_EQ(counts.functions[1].name, "memcpy");
  EXPECT_EQ(counts.functions[1].max, 10U);
  ASSERT_EQ(counts.code.size(), 2U);
  EXPECT_EQ(counts.code[0].begin, 0x800U);
  EXPECT_EQ(counts.code[0].end, 0x81CU);
}

TEST(InstructionCounts, RefusesTruncatedReport) {
  for (const char* report : {"", "ticks 4 30 100 77 5000\n", "ticks 4 30\nend\n", "end"}) {
    if (std::string(report) == "end") {
      EXPECT_NO_THROW((void)parse_instruction_counts(report));  // no tick at all
      continue;
    }
    EXPECT_THROW((void)parse_instruction_counts(report), emulation::EmulationError) << report;
  }
}

}  // namespace
}  // namespace tactree::test
