#include "tactree/support/output_file.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <csignal>
#include <iterator>

#include "folder_test.hpp"
#include "tactree/support/user_error.hpp"

namespace tactree::support {
namespace {

class GrowingFileTest : public test::FolderTest {
 protected:
  [[nodiscard]] std::string content(const char* name) const {
    std::ifstream in(folder_ / name, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
};

TEST_F(GrowingFileTest, AppearsOnCompletion) {
  GrowingFile file(folder_ / "a");
  file.append("one ");
  file.append("two");
  EXPECT_FALSE(std::filesystem::exists(folder_ / "a"));
  EXPECT_EQ(content("a.incomplete"), "one two");
  file.finish();
  EXPECT_EQ(content("a"), "one two");
  EXPECT_FALSE(std::filesystem::exists(folder_ / "a.incomplete"));
}

TEST_F(GrowingFileTest, KeepsIncompleteDataOfOtherProgram) {
  write("a.incomplete", "rows");
  EXPECT_THROW(GrowingFile(folder_ / "a"), UserError);
  EXPECT_EQ(content("a.incomplete"), "rows");
}

TEST_F(GrowingFileTest, LeavesNoEmptyFile) {
  { const GrowingFile file(folder_ / "a"); }
  EXPECT_TRUE(std::filesystem::is_empty(folder_));
}

// The limit on the size of a file stands for a full disk.
TEST_F(GrowingFileTest, KeepsWholeAppendsOnFullDisk) {
  struct rlimit before {};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  const auto old_handler = std::signal(SIGXFSZ, SIG_IGN);
  GrowingFile file(folder_ / "a");
  file.append("12345678");
  struct rlimit small = before;
  small.rlim_cur = 10;
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
  EXPECT_THROW(file.append("abcdefgh"), UserError);
  EXPECT_NE(file.reserve(100), 0);
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &before), 0);
  std::signal(SIGXFSZ, old_handler);
  file.finish();
  EXPECT_EQ(content("a"), "12345678");
}

}  // namespace
}  // namespace tactree::support
