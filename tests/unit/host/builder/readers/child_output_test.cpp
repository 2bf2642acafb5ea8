#include "readers/child_output.hpp"

#include <gtest/gtest.h>

#include <array>
#include <string>

namespace tactree::builder {
namespace {

using Clock = ChildOutput::Clock;

Clock::time_point time_now;  // NOLINT: the tests' own time, which passes only as they set it

TEST(ChildOutput, StopsChildWithClosedOutput) {
  ChildOutput child({"/bin/sh", "-c", "exec 1>&-; exec sleep 600"}, 10.0, [] { return time_now; });
  char byte = 0;
  EXPECT_FALSE(child.read(&byte, 1));  // at the end of the output: no time has passed
  time_now += std::chrono::seconds(10);
  EXPECT_EQ(child.wait_and_describe_end(), "took more than 10 seconds and was stopped");
}

TEST(ChildOutput, IsReadWithinTimeOnly) {
  ChildOutput child({"/bin/sh", "-c", "printf abc; exec sleep 600"}, 10.0, [] { return time_now; });
  std::array<char, 3> text{};
  EXPECT_TRUE(child.read(text.data(), text.size()));
  EXPECT_EQ(std::string(text.data(), text.size()), "abc");
  time_now += std::chrono::seconds(10);
  EXPECT_FALSE(child.read(text.data(), 1));
  EXPECT_EQ(child.wait_and_describe_end(), "took more than 10 seconds and was stopped");
}

}  // namespace
}  // namespace tactree::builder
