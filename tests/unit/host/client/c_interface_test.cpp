#include <gtest/gtest.h>

#include <cstring>
#include <memory>
#include <string>

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

TEST(CInterface, ReadsCapabilities) {
  const RunningBoard running;
  tactree_board* const board = tactree_open(running.port().c_str(), 115200, 0);
  ASSERT_NE(board, nullptr);
  tactree_limits limits;
  ASSERT_EQ(tactree_capabilities(board, &limits), 0) << tactree_error(board);
  const core::Configuration c;
  EXPECT_EQ(limits.rate_hz, c.rate_hz);
  EXPECT_EQ(limits.force_max_N, c.limits.force_max_N);
  EXPECT_EQ(limits.bodies, 1U);
  EXPECT_EQ(limits.dead_man_required, 0);
  EXPECT_EQ(limits.watch_only, 0);
  EXPECT_GT(limits.stiffness_limit_N_m, limits.stiffness_N_m);
  EXPECT_EQ(tactree_set_material(board, limits.stiffness_limit_N_m - 1.0F, c.contact.damping_Ns_m,
                                 0.0F, 0.0F),
            0)
      << tactree_error(board);
  EXPECT_EQ(tactree_set_texture(board, 1e-4F, 1e-3F), 0) << tactree_error(board);
  EXPECT_NE(tactree_set_texture(board, 1e-3F, 1e-3F), 0);
  EXPECT_NE(std::strstr(tactree_error(board), "set texture"), nullptr) << tactree_error(board);
  EXPECT_NE(tactree_set_material(board, limits.stiffness_limit_N_m + 1.0F, c.contact.damping_Ns_m,
                                 0.0F, 0.0F),
            0);
  const std::string limit =
      std::to_string(static_cast<unsigned>(limits.stiffness_limit_N_m)) + " N/m";
  EXPECT_NE(std::strstr(tactree_error(board), limit.c_str()), nullptr) << tactree_error(board);
  tactree_close(board);
}

TEST(CInterface, WatchesAndStopsStandAloneBoard) {
  const RunningBoard running(0.04, false);
  tactree_board* const board = tactree_open(running.port().c_str(), 115200, 0);
  ASSERT_NE(board, nullptr);
  tactree_limits limits;
  ASSERT_EQ(tactree_capabilities(board, &limits), 0) << tactree_error(board);
  EXPECT_EQ(limits.watch_only, 1);
  EXPECT_NE(tactree_arm(board, 100), 0);
  EXPECT_NE(std::strstr(tactree_error(board), "arm: the board is operated by its button"), nullptr)
      << tactree_error(board);
  EXPECT_EQ(tactree_stop(board), 0) << tactree_error(board);
  tactree_close(board);
}

// The functions that do not wait cannot fail: without a request, only tactree_connected() shows it.
TEST(CInterface, NamesLossOfBoard) {
  auto running = std::make_unique<RunningBoard>();
  const std::string port = running->port();
  tactree_board* const board = tactree_open(port.c_str(), 115200, 0);
  ASSERT_NE(board, nullptr);
  EXPECT_NE(tactree_set_material(board, -1.0F, 0.0F, 0.0F, 0.0F), 0);
  EXPECT_EQ(std::strstr(tactree_error(board), "disconnected"), nullptr);
  running.reset();
  for (int i = 0; i < 1000 && tactree_connected(board) != 0; ++i) {
    tactree_sleep(board, 10);
  }
  const std::string lost = tactree_error(board);
  EXPECT_NE(lost.find(port + ": the board is disconnected"), std::string::npos) << lost;
  EXPECT_NE(tactree_reconnect(board), 0);
  EXPECT_NE(std::strstr(tactree_error(board), "No such file"), nullptr) << tactree_error(board);
  tactree_close(board);
}

TEST(CInterface, NamesEndOfSession) {
  const RunningBoard running;
  tactree_board* const first = tactree_open(running.port().c_str(), 115200, 0);
  ASSERT_NE(first, nullptr);
  tactree_board* const second = tactree_open(running.port().c_str(), 115200, 0);
  ASSERT_NE(second, nullptr);
  EXPECT_NE(tactree_stop(first) == 0 && tactree_home(first) == 0, true);
  EXPECT_EQ(tactree_in_session(first), 0);
  EXPECT_NE(std::strstr(tactree_error(first), "another program opened a session"), nullptr)
      << tactree_error(first);
  EXPECT_STREQ(tactree_error(second), "");
  tactree_close(second);
  tactree_close(first);
}

}  // namespace
}  // namespace tactree::test
