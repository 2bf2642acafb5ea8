// The host library with a running board.

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "running_board.hpp"
#include "tactree/client/board.hpp"
#include "tactree/client/link_error.hpp"
#include "tactree/client/ports.hpp"
#include "tactree/client/serial_port.hpp"

namespace tactree::test {
namespace {

TEST(Connection, ReportsPortFailureCause) {
  for (const char* port : {"/dev/no-such-port", "/dev/null"}) {
    try {
      client::Board board(port);
      FAIL() << port;
    } catch (const client::LinkError& error) {
      EXPECT_NE(std::string(error.what()).find(port), std::string::npos);
    }
  }
  EXPECT_THROW((void)client::open_serial_port("/dev/null", 12345), client::LinkError);
}

TEST(Connection, NamesDefaultForUnusualSpeed) {
  try {
    (void)client::open_serial_port("/dev/null", 0);
    FAIL();
  } catch (const client::LinkError& error) {
    EXPECT_STREQ(
        error.what(),
        "/dev/null: 0 baud is not a supported speed (the default is 1000000; others are 115200, "
        "921600 and 2000000)");
  }
}

TEST(Connection, RefusesSilentPort) {
  RunningBoard silent;
  silent.freeze(true);
  EXPECT_THROW(client::Board board(silent.port()), client::LinkError);
}

TEST(Connection, FirstRequestBehindStrayBytesIsAnswered) {
  const RunningBoard running;
  std::unique_ptr<client::Transport> port = client::open_port(running.port(), client::kUsualBaud);
  const std::string stray = "AT\r\n";  // of a modem manager
  ASSERT_EQ(port->write(std::as_bytes(std::span(stray))), stray.size());
  const client::Introduction found = client::Board::introduce(std::move(port));
  EXPECT_GT(std::string(found.board.board).size(), 0U);
}

TEST(Connection, TimePassesOnlyOnRequest) {
  const RunningBoard running;
  client::Board board(running.port(), {.link_timeout_ms = 5});
  const auto begin = board.connection().now();
  board.connection().sleep(std::chrono::seconds(10));
  const auto slept = board.connection().now() - begin;
  EXPECT_GE(slept, std::chrono::seconds(10));
  board.arm();  // the link has not been lost
  board.connection().sleep(std::chrono::seconds(10));
  EXPECT_EQ(static_cast<core::State>(board.state().state), core::State::kActive);
}

TEST(Connection, PlacedBodyIsNotTouchedWhereItWas) {
  const RunningBoard running(0.0295);  // the hand presses 0.5 mm deep
  client::Board board(running.port());
  const auto is_touched = [&] {
    board.arm();
    board.subscribe({static_cast<std::uint32_t>(core::wire::TelemetryField::kContact), 1});
    board.connection().sleep(std::chrono::seconds(2));
    const bool touched = board.latest().body != core::kNoBody;
    board.stop();
    return touched;
  };
  EXPECT_TRUE(is_touched());
  core::Pose below{};
  below.translation_m.z = -0.02F;
  board.place_body(0, below);
  EXPECT_FALSE(is_touched());
  board.place_body(0, core::Pose{});
  EXPECT_TRUE(is_touched());
  EXPECT_THROW(board.place_body(7, below), client::LinkError);
  below.translation_m.z = 11.0F;
  EXPECT_THROW(board.place_body(0, below), client::LinkError);
  EXPECT_EQ(core::length(board.model_origin_m()), 0.0F);
}

TEST(Connection, ReadsAndWritesSerialPort) {
  client::PseudoTerminal board;
  const std::unique_ptr<client::Transport> port =
      client::open_port(board.name(), client::kUsualBaud);
  const std::array<std::byte, 3> sent{std::byte{0}, std::byte{0x7F}, std::byte{0xFF}};
  std::array<std::byte, 8> received{};
  ASSERT_EQ(port->write(sent), sent.size());
  ASSERT_EQ(board.read(received), sent.size());
  EXPECT_TRUE(std::equal(sent.begin(), sent.end(), received.begin()));
  ASSERT_EQ(board.write(sent), sent.size());
  port->wait(std::chrono::seconds(10));
  EXPECT_EQ(port->read(received), sent.size());
}

TEST(Connection, SerialPortServesOneProgram) {
  const client::PseudoTerminal board;
  std::unique_ptr<client::Transport> first = client::open_port(board.name(), client::kUsualBaud);
  try {
    (void)client::open_port(board.name(), client::kUsualBaud);
    ADD_FAILURE();
  } catch (const client::LinkError& error) {
    EXPECT_EQ(std::string(error.what()).find(board.name() + ": "), 0U) << error.what();
    EXPECT_NE(std::string(error.what()).find("another program uses it"), std::string::npos);
  }
  first.reset();
  EXPECT_NO_THROW((void)client::open_port(board.name(), client::kUsualBaud));
}

TEST(Connection, RendersContactAndStops) {
  const RunningBoard running(0.0295);
  client::Board board(running.port());
  board.subscribe({0x3FF, 5});
  board.arm();
  EXPECT_TRUE(comes_true(board.connection(), [&] { return board.latest().force_N[2] > 0.05F; }));
  EXPECT_EQ(board.latest().body, 0U);
  board.move_body(0, {{}, {0.0F, 0.0F, -0.01F}});
  EXPECT_TRUE(comes_true(board.connection(), [&] { return board.latest().body == core::kNoBody; }));
  board.stop();
  EXPECT_EQ(static_cast<core::State>(board.state().state), core::State::kIdle);
  EXPECT_EQ(board.connection().refusals(), 0U);
}

// Unplugs the board and plugs it in again under the same name.
TEST(Connection, ReconnectsReturningBoardUnarmed) {
  const std::filesystem::path link =
      std::filesystem::temp_directory_path() / ("tactree-port-" + std::to_string(::getpid()));
  const auto plug_in = [&link](const RunningBoard& running) {
    std::filesystem::remove(link);
    std::filesystem::create_symlink(running.path(), link);
  };
  auto running = std::make_unique<RunningBoard>();
  plug_in(*running);
  client::Board board("step:" + link.string());
  board.subscribe({0x3FF, 5});
  board.arm();
  ASSERT_TRUE(comes_true(board.connection(), [&] { return board.latest().state == 4U; }));
  running.reset();
  EXPECT_TRUE(comes_true(board.connection(), [&] { return !board.connected(); }));
  EXPECT_THROW(board.reconnect(), client::LinkError);
  EXPECT_FALSE(board.connected());
  EXPECT_THROW(board.stop(), client::LinkError);
  EXPECT_EQ(board.latest().header.tick, 0U);
  EXPECT_TRUE(board.take_stream().empty());

  const RunningBoard again;
  plug_in(again);
  board.reconnect();
  EXPECT_TRUE(board.connected());
  EXPECT_TRUE(comes_true(board.connection(),
                         [&] { return board.latest().header.tick > 0U; }));  // subscribed
  EXPECT_EQ(static_cast<core::State>(board.state().state), core::State::kIdle);
  std::filesystem::remove(link);
}

std::string refusal_to_arm(client::Board& board) {
  try {
    board.arm(std::chrono::milliseconds(100));
  } catch (const client::LinkError& error) {
    return error.what();
  }
  return "";
}

TEST(Connection, NamesLatchedFaultAndHint) {
  RunningBoard running;
  client::Board board(running.port());
  running.press_emergency_stop(true);
  ASSERT_TRUE(comes_true(board.connection(), [&] { return board.state().faults != 0U; }));
  running.press_emergency_stop(false);
  const std::string refusal = refusal_to_arm(board);
  EXPECT_NE(refusal.find("fault emergency-stop"), std::string::npos) << refusal;
  EXPECT_NE(refusal.find("tactree arm --clear"), std::string::npos) << refusal;
  board.clear_faults();
  board.arm();
}

// The program is too busy to send heartbeats.
TEST(Connection, NamesLinkTimeoutOfLostLink) {
  const RunningBoard running;
  client::Board board(running.port(), {.link_timeout_ms = 35});
  const std::string lost = board.explain(core::fault_bit(core::Fault::kLinkLost));
  EXPECT_NE(lost.find("for 35 ms"), std::string::npos) << lost;
  EXPECT_NE(lost.find("--link-timeout"), std::string::npos) << lost;
  EXPECT_EQ(board.explain(core::fault_bit(core::Fault::kEmergencyStop)), "emergency-stop");
  EXPECT_EQ(client::Board(running.port()).explain(core::fault_bit(core::Fault::kLinkLost)),
            "link-lost");
}

bool watch_only(const std::string& port) {
  return has_flag(client::Board::introduce(client::open_port(port, 0)).can,
                  core::wire::BoardFlag::kWatchOnly);
}

TEST(Connection, ReportsStandAloneBoardBeforeCommands) {
  const RunningBoard operated;
  EXPECT_FALSE(watch_only(operated.port()));
  client::Board(operated.port()).require_command("arm");
  const RunningBoard watched(0.04, false);
  EXPECT_TRUE(watch_only(watched.port()));
  client::Board board(watched.port());
  const std::string who = ": the board is operated by its button";
  for (const auto& [what, command] : std::vector<std::pair<std::string, std::function<void()>>>{
           {"flash", [&] { board.require_command("flash"); }},
           {"arm", [&] { board.begin_arming(); }},
           {"home", [&] { board.home(); }}}) {
    try {
      command();
      ADD_FAILURE() << what;
    } catch (const client::LinkError& error) {
      EXPECT_NE(std::string(error.what()).find(what + who), std::string::npos) << error.what();
      EXPECT_NE(std::string(error.what()).find("hold its button for 1 s"), std::string::npos);
    }
  }
  board.stop();
}

TEST(Connection, RefusesNamelessReconnect) {
  const RunningBoard running;
  client::Board board(client::open_port(running.port(), 0), {});
  EXPECT_THROW(board.reconnect(), client::LinkError);
  EXPECT_TRUE(board.connected());
}

TEST(Connection, DeliversStreamAndCountsGaps) {
  const RunningBoard running;
  client::Board board(running.port());
  board.subscribe({0x003, 1});
  std::vector<client::Telemetry> all;
  ASSERT_TRUE(comes_true(board.connection(), [&] {
    const auto news = board.take_stream();
    all.insert(all.end(), news.begin(), news.end());
    return all.size() > 500U;
  }));
  std::uint64_t missing = 0;
  for (std::size_t i = 1; i < all.size(); ++i) {
    missing += all[i].header.tick - all[i - 1].header.tick - 1U;
  }
  EXPECT_LE(missing, board.dropped());
}

TEST(Connection, WaitsForStream) {
  const RunningBoard running;
  client::Board board(running.port());
  const client::Connection& connection = board.connection();
  const auto begin = connection.now();
  connection.wait_for_stream(std::chrono::milliseconds(20));  // nothing is subscribed
  EXPECT_GE(connection.now() - begin, std::chrono::milliseconds(20));
  board.subscribe({0x003, 1});
  for (int i = 0; i < 10; ++i) {
    connection.wait_for_stream(std::chrono::seconds(100));
    EXPECT_FALSE(board.take_stream().empty());
  }
  EXPECT_LT(connection.now() - begin, std::chrono::seconds(100));
}

TEST(Connection, LimitsUnreadStream) {
  const RunningBoard running;
  client::ConnectionOptions options;
  options.stream_capacity = 10;
  client::Connection connection(client::open_port(running.port(), 0), options);
  connection.open(0);
  ASSERT_TRUE(
      connection.call(core::wire::MessageKind::kSubscribe, core::wire::SubscribeRequest{1, 1})
          .ok());
  EXPECT_TRUE(comes_true(connection, [&] { return connection.dropped() > 20U; }));
  EXPECT_EQ(connection.take_stream().size(), 10U);
}

TEST(Connection, CountsRefusedPosts) {
  const RunningBoard running;
  client::Board board(running.port());
  board.add_force({1.0F, 0.0F, 0.0F}, 20);  // not active
  EXPECT_TRUE(comes_true(board.connection(), [&] { return board.connection().refusals() == 1U; }));
}

TEST(Connection, ManagesModelsTraceAndParameters) {
  const RunningBoard running;
  client::Board board(running.port());
  const TestBlob one(sphere(0.02, 0.002));
  const TestBlob two(sphere(0.025, 0.002));
  for (const TestBlob* blob : {&one, &two}) {
    client::ModelFile model;
    model.bytes = std::as_bytes(std::span(blob->written().bytes));
    std::size_t done = 0;
    board.flash(model, [&](std::size_t now, std::size_t) { done = now; });
    EXPECT_EQ(done, model.bytes.size());
  }
  EXPECT_EQ(board.models().slot[1].points, two.view().point_count());
  board.roll_back();
  EXPECT_EQ(board.models().slot[0].state,
            static_cast<std::uint8_t>(core::wire::SlotState::kActive));
  board.erase_model(1);
  EXPECT_THROW(board.roll_back(), client::LinkError);

  const std::vector<client::TracedTick> trace = board.trace();
  ASSERT_GE(trace.size(), 100U);
  EXPECT_LT(trace.front().tick, trace.back().tick);

  board.set_parameter("hand_damping_Ns_m", 2.0F);
  board.save_parameters();
  bool found = false;
  for (const core::wire::ParameterReply& p : board.parameters()) {
    found = found || (std::string(p.name) == "hand_damping_Ns_m" && p.value == 2.0F);
  }
  EXPECT_TRUE(found);
  EXPECT_THROW(board.set_parameter("no such", 1.0F), client::LinkError);
  EXPECT_THROW(board.set_parameter("delay_s", 5.0F), client::LinkError);
}

}  // namespace
}  // namespace tactree::test
