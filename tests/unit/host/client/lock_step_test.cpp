// A board in lock-step that cannot be started, or is not there, leaves nothing behind.

#include "tactree/client/lock_step.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <iterator>
#include <optional>

#include "message_of.hpp"
#include "tactree/client/link_error.hpp"

namespace tactree::test {
namespace {

namespace fs = std::filesystem;

std::ptrdiff_t open_descriptors() {
  return std::distance(fs::directory_iterator("/proc/self/fd"), fs::directory_iterator());
}

/// Sets the folder for temporary files.
class TemporaryFolder {
 public:
  explicit TemporaryFolder(const fs::path& folder) {
    if (const char* const before = std::getenv("TMPDIR")) {
      before_ = before;
    }
    ::setenv("TMPDIR", folder.c_str(), 1);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  ~TemporaryFolder() {
    if (before_) {
      ::setenv("TMPDIR", before_->c_str(), 1);
    } else {
      ::unsetenv("TMPDIR");
    }
  }

 private:
  std::optional<std::string> before_;
};

std::string refusal_in(const fs::path& folder) {
  const TemporaryFolder set(folder);
  return message_of<client::LinkError>([] { const client::LockStepServer server; });
}

TEST(LockStep, FailedServerLeavesNothingBehind) {
  const std::ptrdiff_t before = open_descriptors();
  EXPECT_NE(refusal_in("/no/such/folder").find("set TMPDIR"), std::string::npos);
  EXPECT_NE(refusal_in("/proc").find("/proc/tactree-"), std::string::npos);

  // Of a socket the path has less than 108 characters.
  const fs::path parent = fs::temp_directory_path() / ("tactree-" + std::to_string(::getpid()));
  const fs::path longest = parent / std::string(120, 'x');
  fs::create_directories(longest);
  EXPECT_NE(refusal_in(longest).find("not the path of a socket"), std::string::npos);
  EXPECT_TRUE(fs::is_empty(longest));
  fs::remove_all(parent);
  EXPECT_EQ(open_descriptors(), before);
}

TEST(LockStep, FailedPortLeavesNothingBehind) {
  const std::ptrdiff_t before = open_descriptors();
  EXPECT_THROW((void)client::open_lock_step(std::string(120, 'x')), client::LinkError);
  EXPECT_THROW((void)client::open_lock_step("/no/such/socket"), client::LinkError);
  EXPECT_EQ(open_descriptors(), before);
}

}  // namespace
}  // namespace tactree::test
