#include "tactree/support/spooled_input.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <iterator>
#include <thread>

#include "folder_test.hpp"
#include "tactree/support/user_error.hpp"

namespace tactree::cli {
namespace {

namespace fs = std::filesystem;

class SpooledInputTest : public test::FolderTest {
 protected:
  /// The text of the copy of what another thread writes into a pipe.
  std::string copy_of(const std::string& text,
                      const support::FreeSpace& space = support::free_space) const {
    int ends[2] = {-1, -1};
    EXPECT_EQ(::pipe(ends), 0);
    std::thread writer([&] {
      std::size_t written = 0;
      while (written < text.size()) {
        const ssize_t count = ::write(ends[1], text.data() + written, text.size() - written);
        if (count <= 0) {
          break;
        }
        written += static_cast<std::size_t>(count);
      }
      ::close(ends[1]);
    });
    std::string copy;
    try {
      const support::SpooledInput spooled(ends[0], folder_, space);
      std::ifstream in(spooled.path(), std::ios::binary);
      copy.assign(std::istreambuf_iterator<char>(in), {});
      EXPECT_EQ(fs::file_size(spooled.path()), copy.size());
      EXPECT_TRUE(fs::is_empty(folder_));
    } catch (const support::UserError& error) {
      copy = error.what();
      char ignored = 0;
      while (::read(ends[0], &ignored, 1) > 0) {
      }
    }
    writer.join();
    ::close(ends[0]);
    return copy;
  }
};

TEST_F(SpooledInputTest, CopiesPipeLeavingNoFile) {
  const std::string text = std::string(3'000'001, 'a') + "end";
  EXPECT_EQ(copy_of(text), text);
  EXPECT_EQ(copy_of(""), "");
  EXPECT_TRUE(fs::is_empty(folder_));
}

TEST_F(SpooledInputTest, KeepsSpaceFree) {
  const std::string text(2'000'000, 'a');
  const auto space = [](std::uint64_t bytes) {
    return [bytes](const fs::path&) { return support::kSpoolReserve + bytes; };
  };
  EXPECT_EQ(copy_of(text, space(1U << 20)), text);  // at least a block is free, each time
  const std::string refusal = copy_of(text, space(0));
  EXPECT_NE(refusal.find("less than 64 MiB are free there"), std::string::npos) << refusal;
  EXPECT_NE(refusal.find("set TMPDIR to a folder with enough room"), std::string::npos);
  EXPECT_TRUE(fs::is_empty(folder_));
}

TEST_F(SpooledInputTest, NamesMissingFolder) {
  fs::remove_all(folder_);
  EXPECT_NE(copy_of("text").find("standard input: it cannot be stored in " + folder_.string()),
            std::string::npos);
}

}  // namespace
}  // namespace tactree::cli
