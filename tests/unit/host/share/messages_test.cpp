#include "tactree/share/messages.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tactree/core/safety/faults.hpp"

namespace tactree::test {
namespace {

using nlohmann::json;
using share::BoardRequest;

share::Snapshot snapshot() {
  share::Description board;
  board.device_id = "0A";
  board.name = "host";
  board.origin_m = {0.25F, 0.0F, 0.5F};
  board.model_name = "ball";
  board.model_points = 3000U;
  share::Snapshot s;
  s.board = std::make_shared<const share::Description>(board);
  s.tick.header.tick = 7;
  s.tick.state = 4;
  s.tick.probe_m[0] = 0.25F;
  s.tick.velocity_m_s[1] = -2.0F;
  s.tick.faults = core::fault_bit(core::Fault::kSupply);
  s.tick.limits = core::limit_bit(core::Limit::kForce);
  return s;
}

json written(const share::Snapshot& s, share::Grip grip, bool first) {
  return json::parse(share::state_text(s, grip, {}, first));
}

share::ClientMessage read(const std::string& text) { return share::read_message(text, "0A"); }

std::string force_text(const std::string& values) {
  return R"({"inverse3":[{"device_id":"0A","commands":{"set_cursor_force":{"values":)" + values +
         "}}}]}";
}

TEST(ShareMessages, StatesAddedForceWhereTelemetryHasIt) {
  share::Snapshot s = snapshot();
  s.tick.added_N[2] = 0.5F;
  EXPECT_FALSE(written(s, share::Grip::kNone, false)["tactree"].contains("added_N"));
  s.tick.header.fields = static_cast<std::uint32_t>(core::wire::TelemetryField::kParts);
  EXPECT_EQ(written(s, share::Grip::kNone, false)["tactree"]["added_N"]["z"], 0.5);
}

TEST(ShareMessages, StatesPositionInFrameOfDevice) {
  const json state = written(snapshot(), share::Grip::kNeutral, false);
  const json& device = state["inverse3"][0];
  EXPECT_EQ(device["device_id"], "0A");
  EXPECT_FALSE(device.contains("config"));
  EXPECT_EQ(device["state"]["cursor_position"], json({{"x", 0.5}, {"y", 0.0}, {"z", 0.5}}));
  EXPECT_EQ(device["state"]["cursor_velocity"], json({{"x", 0.0}, {"y", -2.0}, {"z", 0.0}}));
  EXPECT_EQ(state["wireless_verse_grip"][0]["state"]["orientation"]["w"], 1.0);
  const json& own = state["tactree"];
  EXPECT_EQ(own["state"], "active");
  EXPECT_EQ(own["faults"], json::array({"supply"}));
  EXPECT_EQ(own["limits"], json::array({"force"}));
  EXPECT_TRUE(own["contact"].is_null());
  EXPECT_TRUE(own["command"].is_null());
  EXPECT_FALSE(own.contains("model"));
}

TEST(ShareMessages, DescribesBoardFirst) {
  const json state = written(snapshot(), share::Grip::kNone, true);
  EXPECT_TRUE(state["inverse3"][0].contains("config"));
  EXPECT_TRUE(state["wireless_verse_grip"].empty());
  EXPECT_EQ(state["tactree"]["board"]["name"], "host");
  EXPECT_EQ(state["tactree"]["model"], json({{"name", "ball"}, {"points", 3000}}));
}

TEST(ShareMessages, StatesContactAndCommander) {
  share::Snapshot s = snapshot();
  s.tick.body = 1;
  s.tick.penetration_m = 0.5F;
  s.tick.normal[2] = 1.0F;
  const json own =
      json::parse(share::state_text(s, share::Grip::kNone, {2, "here:1"}, false))["tactree"];
  EXPECT_EQ(own["contact"]["body"], 1);
  EXPECT_EQ(own["contact"]["depth_m"], 0.5);
  EXPECT_EQ(own["contact"]["normal"]["z"], 1.0);
  EXPECT_EQ(own["command"]["client"], 2);
  EXPECT_EQ(own["command"]["address"], "here:1");
}

TEST(ShareMessages, LostBoardIsNoDevice) {
  share::Snapshot s = snapshot();
  s.link = share::Link::kLost;
  s.why = "unplugged";
  const json state = written(s, share::Grip::kNeutral, false);
  EXPECT_TRUE(state["inverse3"].empty());
  EXPECT_TRUE(state["wireless_verse_grip"].empty());
  EXPECT_EQ(state["tactree"]["link"], "lost");
  EXPECT_EQ(state["tactree"]["why"], "unplugged");
}

TEST(ShareMessages, AddsFactsOfOneClient) {
  const std::string state = share::state_text(snapshot(), share::Grip::kNone, {}, false);
  const json told = json::parse(share::with_facts(state, {3, true, 5, 2}, "why \"not\""));
  EXPECT_EQ(told["tactree"]["tick"], 7);
  EXPECT_EQ(told["tactree"]["client"], json({{"number", 3},
                                             {"in_command", true},
                                             {"dropped", 5},
                                             {"every_ticks", 2},
                                             {"refused", "why \"not\""}}));
}

TEST(ShareMessages, ReadsForce) {
  const share::ClientMessage message = read(force_text(R"({"x":0.5,"y":-1,"z":0})"));
  EXPECT_EQ(message.refusal, "");
  ASSERT_TRUE(message.force_N);
  EXPECT_EQ((*message.force_N)[0], 0.5F);
  EXPECT_EQ((*message.force_N)[1], -1.0F);
}

TEST(ShareMessages, ReadsRequestsInOrderOfExecution) {
  const share::ClientMessage message = read(
      R"({"tactree":{"arm":true,"home":true,"clear":true,"subscribe":{"rate_hz":60,"queue":8}}})");
  EXPECT_EQ(message.refusal, "");
  EXPECT_EQ(message.requests,
            (std::vector{BoardRequest::kClear, BoardRequest::kHome, BoardRequest::kArm}));
  ASSERT_TRUE(message.subscription);
  EXPECT_EQ(message.subscription->rate_hz, 60.0);
  EXPECT_EQ(message.subscription->queue, 8U);
  EXPECT_TRUE(read(R"({"tactree":{"arm":false}})").requests.empty());
}

TEST(ShareMessages, StopCountsInWrongMessage) {
  for (const char* text : {R"({"tactree":{"stop":1,"fly":true}})",
                           R"({"inverse3":7,"tactree":{"stop":{},"arm":"yes"}})"}) {
    const share::ClientMessage message = read(text);
    EXPECT_TRUE(message.stop) << text;
    EXPECT_NE(message.refusal, "") << text;
  }
}

TEST(ShareMessages, RefusesWrongMessages) {
  for (const std::string& text :
       {std::string("no JSON"), std::string("[]"), std::string(R"({"tactree":7})"),
        std::string(R"({"tactree":{"subscribe":{"rate_hz":-1}}})"),
        std::string(R"({"tactree":{"subscribe":{"rate_hz":10,"queue":0}}})"),
        std::string(R"({"inverse3":[{"device_id":"0B"}]})"),
        std::string(R"({"inverse3":[{"device_id":"0A","commands":{"set_cursor_position":{}}}]})"),
        force_text("7"), force_text(R"({"x":1,"y":2})"), force_text(R"({"x":1,"y":2,"z":"3"})"),
        force_text(R"({"x":1e39,"y":2,"z":3})")}) {
    const share::ClientMessage message = read(text);
    EXPECT_NE(message.refusal, "") << text;
    EXPECT_FALSE(message.force_N) << text;
    EXPECT_FALSE(message.subscription) << text;
  }
}

TEST(ShareMessages, RefusalHasTheFormOfAState) {
  const json refusal = json::parse(share::refusal_text("there are 32 clients"));
  EXPECT_EQ(refusal["inverse3"], json::array());
  EXPECT_EQ(refusal["tactree"]["client"]["refused"], "there are 32 clients");
}

}  // namespace
}  // namespace tactree::test
