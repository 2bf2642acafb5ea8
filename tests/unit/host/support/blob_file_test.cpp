#include "tactree/support/blob_file.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <fstream>
#include <iterator>
#include <string>

#include "folder_test.hpp"
#include "folders.hpp"
#include "message_of.hpp"
#include "tactree/support/user_error.hpp"

namespace tactree::cli {
namespace {

namespace fs = std::filesystem;

class BlobFileTest : public test::FolderTest {
 protected:
  static std::string valid_blob() {
    std::ifstream in(test::source_folder() / "tests/golden/surface-1.0.blob", std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }

  /// A file that begins with `text` and has `size` bytes, of which the rest takes no space.
  fs::path write(const std::string& text, std::uintmax_t size) const {
    const fs::path file = FolderTest::write("a.blob", text);
    fs::resize_file(file, size);
    return file;
  }

  static std::string refusal_of(const fs::path& file) {
    return test::message_of<support::UserError>([&] { const support::BlobFile blob(file); });
  }
};

constexpr std::uintmax_t kTerabyte = std::uintmax_t{1} << 40;

// Reading 1 TiB would fail for want of memory, or last for minutes.
TEST_F(BlobFileTest, RefusesForeignFileByHeader) {
  EXPECT_NE(refusal_of(write("ply\nformat ascii 1.0\n", kTerabyte)).find("not a Tactree blob"),
            std::string::npos);
}

TEST_F(BlobFileTest, RefusesSizeContradictingHeader) {
  const std::string valid = valid_blob();
  ASSERT_FALSE(valid.empty());
  for (const std::uintmax_t size : {valid.size() - 4, valid.size() + 1, std::size_t{kTerabyte}}) {
    const std::string refusal = refusal_of(write(valid, size));
    EXPECT_NE(refusal.find("its header states " + std::to_string(valid.size()) +
                           " bytes, the file has " + std::to_string(size)),
              std::string::npos)
        << refusal;
  }
  EXPECT_EQ(refusal_of(write(valid, valid.size())), "");
}

TEST_F(BlobFileTest, RefusesFileShorterThanHeader) {
  for (const std::size_t size : {std::size_t{0}, std::size_t{7}, sizeof(core::BlobHeader) - 1}) {
    EXPECT_NE(refusal_of(write(valid_blob().substr(0, size), size)).find("shorter than"),
              std::string::npos)
        << size;
  }
}

TEST_F(BlobFileTest, RefusesPipeWithoutWaiting) {
  const fs::path pipe = folder_ / "pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_NE(refusal_of(pipe).find("is a pipe or a device"), std::string::npos);
}

}  // namespace
}  // namespace tactree::cli
