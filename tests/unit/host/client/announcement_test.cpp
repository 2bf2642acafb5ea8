#include "tactree/client/announcement.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <optional>

#include "folder_test.hpp"
#include "tactree/client/link_error.hpp"

namespace tactree::test {
namespace {

class AnnouncementTest : public FolderTest {
 protected:
  AnnouncementTest() { EXPECT_EQ(::setenv("XDG_RUNTIME_DIR", folder_.c_str(), 1), 0); }
  ~AnnouncementTest() override { ::unsetenv("XDG_RUNTIME_DIR"); }
};

TEST_F(AnnouncementTest, LastsAsLongAsItsProgram) {
  EXPECT_TRUE(client::announced_ports().empty());
  std::optional<client::Announcement> second(std::in_place,
                                             client::AnnouncedPort{"/dev/pts/8", "two"});
  const client::Announcement first({"/dev/pts/7", "one"});
  auto ports = client::announced_ports();
  ASSERT_EQ(ports.size(), 2U);
  EXPECT_EQ(ports[0].port, "/dev/pts/7");
  EXPECT_EQ(ports[0].about, "one");
  second.reset();
  ports = client::announced_ports();
  ASSERT_EQ(ports.size(), 1U);
  EXPECT_EQ(ports[0].about, "one");
}

// A program that was killed leaves its file, without its lock.
TEST_F(AnnouncementTest, RemovesFileOfKilledProgram) {
  { const client::Announcement creates_the_folder({"/dev/pts/7", "one"}); }
  const std::filesystem::path left = write("tactree/left", "/dev/pts/9\nleft\n");
  EXPECT_TRUE(client::announced_ports().empty());
  EXPECT_FALSE(std::filesystem::exists(left));
}

TEST_F(AnnouncementTest, RefusesFolderWritableByOthers) {
  ASSERT_EQ(::mkdir((folder_ / "tactree").c_str(), 0700), 0);
  ASSERT_EQ(::chmod((folder_ / "tactree").c_str(), 0777), 0);
  const client::AnnouncedPort port{"/dev/pts/7", "one"};
  EXPECT_THROW(const client::Announcement refused(port), client::LinkError);
}

}  // namespace
}  // namespace tactree::test
