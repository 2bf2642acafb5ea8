#include "tactree/support/csv.hpp"

#include <gtest/gtest.h>

#include "folder_test.hpp"
#include "message_of.hpp"
#include "tactree/support/output_file.hpp"

namespace tactree::support {
namespace {

using Cells = std::vector<std::string_view>;

class CsvFile : public test::FolderTest {
 protected:
  std::filesystem::path write(const std::string& text) const {
    return FolderTest::write("table.csv", text);
  }
};

TEST(SplitCsv, SplitsCommasAndTrimsBlanks) {
  EXPECT_EQ(support::split_csv("a, b c ,d\r"), (Cells{"a", "b c", "d"}));
  EXPECT_EQ(support::split_csv("1,,3,"), (Cells{"1", "", "3", ""}));
  EXPECT_EQ(support::split_csv(" , ,"), (Cells{"", "", ""}));
  EXPECT_EQ(support::split_csv(""), (Cells{""}));
}

TEST(SplitCsv, SplitsAnySeparatorOnRequest) {
  EXPECT_EQ(support::split_csv(" 1 ;2\t3 4 , 5 ", support::CsvSeparator::kAny),
            (Cells{"1", "2", "3", "4", "5"}));
  EXPECT_EQ(support::split_csv("1,;2", support::CsvSeparator::kAny), (Cells{"1", "", "2"}));
  EXPECT_EQ(support::split_csv("1 2 ,", support::CsvSeparator::kAny), (Cells{"1", "2", ""}));
}

TEST_F(CsvFile, ReadsNumbersByColumnName) {
  support::CsvReader table(write("# trace\nt_s,state,x_m\n\n0.5,ready,+1e-3\r\n1,armed,2\n"), {});
  const std::size_t x = table.find_column("x_m").value();
  EXPECT_EQ(table.find_column("state"), 1U);
  EXPECT_EQ(table.find_column("y_m"), std::nullopt);
  ASSERT_TRUE(table.next_row());
  EXPECT_EQ(table.line(), 4U);
  EXPECT_EQ(table.number(x), 1e-3);
  EXPECT_EQ(table.cells()[1], "ready");
  ASSERT_TRUE(table.next_row());
  EXPECT_EQ(table.number(x), 2.0);
  EXPECT_FALSE(table.next_row());
}

TEST_F(CsvFile, AcceptsMissingOptionalHeader) {
  const support::CsvFormat format{.header = support::CsvHeader::kOptional};
  support::CsvReader without(write("1,2\n3,4\n"), format);
  ASSERT_TRUE(without.next_row());
  EXPECT_EQ(without.number(0), 1.0);
  ASSERT_TRUE(without.next_row());
  EXPECT_EQ(without.number(1), 4.0);
  support::CsvReader with(write("x,y\n3,4\n"), format);
  ASSERT_TRUE(with.next_row());
  EXPECT_EQ(with.number(0), 3.0);
  support::CsvReader empty(write(""), format);
  EXPECT_FALSE(empty.next_row());
}

TEST_F(CsvFile, ReportsFileLineAndColumn) {
  const std::filesystem::path file = write("a,b\n1,2\n3,four\n");
  support::CsvReader table(file, {});
  ASSERT_TRUE(table.next_row() && table.next_row());
  EXPECT_EQ(test::message_of<CsvError>([&] { (void)table.number(1); }),
            file.string() + ": line 3: column 2 (b) is not a number: 'four'");
  EXPECT_EQ(test::message_of<CsvError>([&] { (void)table.number(2); }),
            file.string() + ": line 3: has no column 3");
  EXPECT_EQ(test::message_of<CsvError>([&] { table.refuse("time descends", "sort the rows"); }),
            file.string() + ": line 3: time descends (sort the rows)");
}

TEST_F(CsvFile, RefusesNonFiniteNumbers) {
  for (const char* number : {"nan", "inf", "-inf", "1e999", "0x1", "1 2", ""}) {
    support::CsvReader table(write(std::string("a,b\n1,") + number + "\n"), {});
    ASSERT_TRUE(table.next_row());
    EXPECT_THROW((void)table.number(1), support::CsvError) << number;
  }
}

TEST_F(CsvFile, IgnoresCutLastRow) {
  const std::filesystem::path file = write("a,b\n1,2\n3");
  support::CsvReader whole(file, {});
  EXPECT_TRUE(whole.next_row());
  EXPECT_THROW((void)whole.next_row(), CsvError);
  const std::filesystem::path incomplete = file.string() + support::kIncomplete;
  std::filesystem::copy_file(file, incomplete);
  support::CsvReader cut(incomplete, {});
  EXPECT_TRUE(cut.next_row());
  EXPECT_FALSE(cut.next_row());
}

TEST_F(CsvFile, RefusesRowsUnlikeHeader) {
  const std::filesystem::path file = write("a,b\n1,2,3\n");
  support::CsvReader table(file, {});
  EXPECT_EQ(test::message_of<CsvError>([&] { (void)table.next_row(); }),
            file.string() + ": line 2: 3 values, the header has 2");
}

TEST_F(CsvFile, RefusesFoldersAndMissingFiles) {
  EXPECT_NE(
      test::message_of<CsvError>([&] { support::CsvReader(folder_, {}); }).find("is a folder"),
      std::string::npos);
  EXPECT_NE(test::message_of<CsvError>([&] {
              support::CsvReader(folder_ / "none", {});
            }).find("cannot be read: "),
            std::string::npos);
}

}  // namespace
}  // namespace tactree::support
