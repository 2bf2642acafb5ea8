#include <gtest/gtest.h>

#include <cstring>

#include "running_board.hpp"
#include "tactree/client/tactree.h"

extern "C" int c_program(const char* port);

namespace tactree::test {
namespace {

TEST(CInterface, RendersBall) {
  const RunningBoard running(0.0295);
  EXPECT_EQ(c_program(running.port().c_str()), 0);
}

TEST(CInterface, GivesErrorMessages) {
  EXPECT_EQ(tactree_open("/dev/no-such-port", 115200, 0), nullptr);
  EXPECT_NE(std::strstr(tactree_error(nullptr), "/dev/no-such-port"), nullptr);
  const RunningBoard running;
  tactree_board* const board = tactree_open(running.port().c_str(), 115200, 0);
  ASSERT_NE(board, nullptr);
  EXPECT_NE(tactree_set_material(board, -1.0F, 0.0F, 0.0F, 0.0F), 0);
  EXPECT_NE(std::strlen(tactree_error(board)), 0U);
  tactree_close(board);
  tactree_close(nullptr);
}

}  // namespace
}  // namespace tactree::test
