#include "tactree/share/clients.hpp"

#include <gtest/gtest.h>

#include <array>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace tactree::test {
namespace {

using nlohmann::json;
using share::BoardRequest;

/// Notes what it is told.
class NotedCommands : public share::BoardCommands {
 public:
  void add_force(const std::array<float, 3>& force_N) override { forces.push_back(force_N[0]); }
  void stop() override { ++stops; }
  void request(BoardRequest request) override { requests.push_back(request); }

  std::vector<float> forces;
  int stops = 0;
  std::vector<BoardRequest> requests;
};

class ShareClients : public testing::Test {
 protected:
  ShareClients() {
    share::Description board;
    board.device_id = "0A";
    board.can.rate_hz = 1000.0F;
    state_.board = std::make_shared<const share::Description>(board);
    state_.tick.state = 4;  // active
  }
  /// The board runs for some ticks of 1 ms.
  void pass(unsigned ticks = 1) {
    for (unsigned i = 0; i < ticks; ++i) {
      ++state_.tick.header.tick;
      state_.time_us += 1000U;
      clients_.offer(state_);
    }
  }
  void push(unsigned client, double force_N) {
    const json values = {{"x", force_N}, {"y", 0.0}, {"z", 0.0}};
    const json command = {{"set_cursor_force", {{"values", values}}}};
    const json device = {{"device_id", "0A"}, {"commands", command}};
    clients_.receive(client, json::object({{"inverse3", json::array({device})}}).dump());
  }
  /// What a client reads next; null if nothing.
  json read_next(unsigned client) {
    const share::Message message = clients_.next(client);
    return message == nullptr ? json() : json::parse(*message);
  }
  std::string refusal(unsigned client) {
    const json state = read_next(client);
    return state.is_null() ? "no message" : state["tactree"]["client"].value("refused", "");
  }

  NotedCommands board_;
  share::Clients clients_{board_, share::Grip::kNeutral};
  share::Snapshot state_;
};

TEST_F(ShareClients, GetOneStateForEachMessage) {
  const unsigned one = clients_.join("here:1");
  EXPECT_TRUE(read_next(one).is_null());  // the board has not reported yet
  pass();
  EXPECT_TRUE(read_next(one)["inverse3"][0].contains("config"));
  pass(3);
  EXPECT_TRUE(read_next(one).is_null());
  push(one, 0.0);
  const json state = read_next(one);  // the newest
  EXPECT_EQ(state["tactree"]["tick"], 4);
  EXPECT_FALSE(state["inverse3"][0].contains("config"));
  push(one, 0.0);
  EXPECT_TRUE(read_next(one).is_null());  // known
  pass();
  EXPECT_EQ(read_next(one)["tactree"]["tick"], 5);
}

TEST_F(ShareClients, ShareTheTextOfState) {
  const unsigned one = clients_.join("here:1");
  const unsigned two = clients_.join("here:2");
  pass();
  (void)read_next(one);
  (void)read_next(two);
  push(one, 0.0);
  push(two, 0.0);
  pass();
  const share::Message text = clients_.next(one);
  ASSERT_NE(text, nullptr);
  EXPECT_EQ(text, clients_.next(two));
}

TEST_F(ShareClients, FirstForceTakesCommand) {
  const unsigned one = clients_.join("here:1");
  const unsigned two = clients_.join("here:2");
  pass();
  (void)read_next(one);
  (void)read_next(two);
  push(one, 0.0);  // only watches
  push(two, 1.0);
  pass(12'000);
  push(one, 3.0);
  EXPECT_EQ(board_.forces, std::vector<float>{1.0F});
  EXPECT_EQ(refusal(one),
            "set_cursor_force: client 2, here:2, has command since 12 s (end it, or have it send "
            "release_command)");
  EXPECT_EQ(read_next(two)["tactree"]["client"]["in_command"], true);
  clients_.leave(two);
  push(one, 3.0);
  EXPECT_EQ(board_.forces, (std::vector<float>{1.0F, 3.0F}));
}

TEST_F(ShareClients, ForceIsSentOncePerState) {
  const unsigned one = clients_.join("here:1");
  pass();
  push(one, 1.0);
  push(one, 2.0);
  push(one, 3.0);
  EXPECT_EQ(board_.forces, std::vector<float>{1.0F});
  pass();
  EXPECT_EQ(board_.forces, (std::vector<float>{1.0F, 3.0F}));
  pass(200);  // does not persist
  EXPECT_EQ(board_.forces.size(), 2U);
  push(one, 4.0);
  push(one, 5.0);
  clients_.receive(one, R"({"tactree":{"stop":true}})");
  pass();
  EXPECT_EQ(board_.forces.back(), 4.0F);
}

TEST_F(ShareClients, RefusesForceOfStoppedBoard) {
  const unsigned one = clients_.join("here:1");
  state_.tick.state = 2;  // idle
  pass();
  push(one, 1.0);
  EXPECT_TRUE(board_.forces.empty());
  EXPECT_NE(refusal(one).find("in state idle"), std::string::npos);
  EXPECT_EQ(clients_.in_command(), 0U);  // so that another program can arm
  const unsigned two = clients_.join("here:2");
  clients_.receive(two, R"({"tactree":{"arm":true}})");
  EXPECT_EQ(board_.requests, std::vector{BoardRequest::kArm});
  pass();
  push(one, 1.0);
  EXPECT_NE(refusal(one).find("client 2, here:2, has command"), std::string::npos);
}

TEST_F(ShareClients, AnyoneMayStopAndOneMayArm) {
  const unsigned one = clients_.join("here:1");
  const unsigned two = clients_.join("here:2");
  pass();
  clients_.receive(one, R"({"tactree":{"arm":true}})");
  clients_.receive(two, R"({"tactree":{"arm":true}})");
  EXPECT_EQ(board_.requests, std::vector{BoardRequest::kArm});
  EXPECT_EQ(clients_.in_command(), one);
  EXPECT_NE(refusal(two).find("arm: client 1, here:1, has command"), std::string::npos);
  clients_.receive(two, R"({"tactree":{"stop":true}})");
  EXPECT_EQ(board_.stops, 1);
  clients_.receive(one, R"({"tactree":{"release_command":true}})");
  clients_.receive(two, R"({"tactree":{"take_command":true,"arm":true}})");
  EXPECT_EQ(board_.requests.size(), 2U);
  clients_.leave(one);
  EXPECT_EQ(board_.stops, 1);
  clients_.leave(two);  // has armed the board
  EXPECT_EQ(board_.stops, 2);
}

TEST_F(ShareClients, SubscriptionNeedsNoMessages) {
  const unsigned one = clients_.join("here:1");
  pass();
  (void)read_next(one);
  clients_.receive(one, R"({"tactree":{"subscribe":{"rate_hz":250,"queue":2}}})");
  pass(20);  // is not read: five are due, two wait
  json state = read_next(one);
  EXPECT_EQ(state["tactree"]["tick"], 14);
  EXPECT_EQ(state["tactree"]["client"]["dropped"], 3);
  EXPECT_EQ(state["tactree"]["client"]["every_ticks"], 4);
  state = read_next(one);
  EXPECT_EQ(state["tactree"]["tick"], 18);
  EXPECT_TRUE(read_next(one).is_null());
}

TEST_F(ShareClients, AreTooMany) {
  for (std::size_t i = 0; i < share::Clients::kMaxClients; ++i) {
    EXPECT_EQ(clients_.join("here"), i + 1U);
  }
  EXPECT_EQ(clients_.join("here"), 0U);
}

}  // namespace
}  // namespace tactree::test
