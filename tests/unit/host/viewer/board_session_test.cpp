// A session with a simulated board: frames, commands, loss of the connection.

#include "tactree/viewer/board_session.hpp"

#include <unistd.h>

#include <filesystem>

#include "folder_test.hpp"
#include "frames.hpp"
#include "running_board.hpp"
#include "tactree/client/link_error.hpp"
#include "tactree/client/ports.hpp"
#include "tactree/core/configuration/device_presets.hpp"
#include "tactree/support/csv.hpp"

namespace tactree::test {
namespace {

using nlohmann::json;
using viewer::BoardSession;

bool is_here(const json& frame) {
  return frame["board"]["link"] == "here" && !frame["runs"].empty();
}

/// A stable name for the board's port, like a cable.
class Cable {
 public:
  ~Cable() { std::filesystem::remove(name_); }
  void plug_in(const RunningBoard& board) {
    std::filesystem::remove(name_);
    std::filesystem::create_symlink(board.path(), name_);
  }
  [[nodiscard]] std::string name() const { return "step:" + name_.string(); }

 private:
  std::filesystem::path name_ = std::filesystem::temp_directory_path() /
                                ("tactree-board-session-" + std::to_string(::getpid()));
};

class BoardSessionTest : public FolderTest {
 protected:
  static viewer::Bodies bodies() {
    simulation::SceneBody body;
    body.blob = RunningBoard::model().written().bytes;
    return {{RunningBoard::model().view()}, {body}};
  }
  static viewer::BoardSettings settings(const std::string& port) {
    viewer::BoardSettings settings;
    settings.port = port;
    // The maximum: the computer of a test may be busy.
    settings.link.link_timeout_ms = 100;
    settings.device = core::presets::premium().model;
    settings.work = [](const std::string& board, const core::wire::CapabilitiesReply& can) {
      return viewer::Work{"instructions of " + board, static_cast<double>(can.rate_hz), 900.0, ""};
    };
    settings.model = std::as_bytes(std::span(RunningBoard::model().written().bytes));
    return settings;
  }

  void plug_in(double height_m = 0.0295) {
    running_ = std::make_unique<RunningBoard>(height_m);
    cable_.plug_in(*running_);
  }
  void begin() {
    viewer::BoardSettings chosen = settings(cable_.name());
    chosen.link.stream_capacity = 65536;
    chosen.recording.file = folder_ / "ticks.csv";
    session_ = std::make_unique<BoardSession>(bodies(), std::move(chosen));
    session_->start(frames_.taker());
  }
  /// Keeps the board armed until `holds`; rearms after a link loss on a busy computer.
  json while_armed(const std::function<bool(const json&)>& holds) {
    return frames_.wait_for([&](const json& frame) {
      if (is_here(frame) && frame["runs"][0]["state"] == "fault") {
        (void)session_->command({{"do", "clear"}});
      } else if (is_idle(frame)) {
        (void)session_->command({{"do", "arm"}});
      }
      return holds(frame);
    });
  }
  void arm() { (void)while_armed(is_active); }
  static bool is_recording(const json& frame) {
    const std::string text = frame["recording"]["text"];
    return frame["recording"]["state"] == "on" && text.find(": 0 ticks") == std::string::npos;
  }
  [[nodiscard]] std::vector<std::uint32_t> recorded_ticks() const {
    support::CsvReader table(folder_ / "ticks.csv", {});
    const std::size_t column = table.find_column("tick").value();
    std::vector<std::uint32_t> ticks;
    while (table.next_row()) {
      ticks.push_back(static_cast<std::uint32_t>(table.number(column)));
    }
    return ticks;
  }
  static bool is_active(const json& frame) {
    return is_here(frame) && frame["runs"][0]["state"] == "active";
  }
  static bool is_idle(const json& frame) {
    return is_here(frame) && frame["runs"][0]["state"] == "idle";
  }
  void open_in_another_program() {
    client::Connection(client::open_port(running_->port(), 0)).open(0);
  }
  void say(const json& command) { EXPECT_EQ(session_->command(command).value_or(""), ""); }
  std::string refusal(const json& command) {
    return session_->command(command).value_or("accepted");
  }

  Cable cable_;
  Frames frames_;
  std::unique_ptr<RunningBoard> running_;
  std::unique_ptr<BoardSession> session_;
};

TEST_F(BoardSessionTest, ReportsForceUntilStopped) {
  plug_in();
  begin();
  arm();
  const json frame = frames_.wait_for(
      [](const json& f) { return is_here(f) && f["runs"][0]["force_N"][2].get<double>() > 0.05; });
  const json& run = frame["runs"][0];
  EXPECT_EQ(run["in_contact"], true);
  EXPECT_GT(run["penetration_m"].get<double>(), 0.0);
  EXPECT_NEAR(core::length({run["proxy_m"][0], run["proxy_m"][1], run["proxy_m"][2]}), 0.03F,
              5e-4F);
  EXPECT_GT(run["candidates"].size(), 5U);
  EXPECT_GE(run["strip"]["force_N"][1], run["force_N"][2]);
  EXPECT_TRUE(run["slipping"].is_null());
  say({{"do", "stop"}});
  const json idle = frames_.wait_for(is_idle);
  EXPECT_EQ(idle["runs"][0]["force_N"], json({0.0, 0.0, 0.0}));
}

TEST_F(BoardSessionTest, StopCancelsQueuedArm) {
  plug_in();
  begin();
  frames_.wait_for(is_idle);
  for (int i = 0; i < 20; ++i) {
    say({{"do", "arm"}});
    say({{"do", "stop"}});
  }
  for (int i = 0; i < 60; ++i) {
    frames_.wait_for([](const json&) { return true; });
  }
  frames_.wait_for(is_idle);
  EXPECT_EQ(frames_.wait_for([](const json&) { return true; })["board"]["confirm"], "");
}

TEST_F(BoardSessionTest, ClearsFaultOnceCauseEnds) {
  plug_in(0.04);
  begin();
  arm();
  running_->press_emergency_stop(true);
  const json frame =
      frames_.wait_for([](const json& f) { return is_here(f) && !f["runs"][0]["faults"].empty(); });
  EXPECT_EQ(frame["runs"][0]["faults"][0]["name"], "emergency-stop");
  say({{"do", "clear"}});
  frames_.wait_for([](const json& f) { return is_here(f) && f["runs"][0]["state"] == "fault"; });
  running_->press_emergency_stop(false);
  frames_.wait_for([&](const json& f) {
    (void)session_->command({{"do", "clear"}});
    return is_idle(f) && f["runs"][0]["faults"].empty();
  });
}

TEST_F(BoardSessionTest, ReconnectsReturningBoardUnarmed) {
  plug_in();
  begin();
  arm();
  running_.reset();
  const json gone = frames_.wait_for([](const json& f) { return f["board"]["link"] == "gone"; });
  EXPECT_TRUE(gone["runs"].empty());
  EXPECT_FALSE(gone["board"]["why"].get<std::string>().empty());
  EXPECT_NE(refusal({{"do", "arm"}}), "accepted");
  EXPECT_NE(refusal({{"do", "stop"}}).find("emergency stop"), std::string::npos);
  plug_in();
  frames_.wait_for(is_idle);
  for (int i = 0; i < 60; ++i) {
    const json frame = frames_.wait_for(is_here);
    EXPECT_EQ(frame["runs"][0]["state"], "idle");
  }
  arm();
}

TEST_F(BoardSessionTest, ReportsSilentBoardAsLost) {
  plug_in();
  begin();
  frames_.wait_for(is_idle);
  running_->freeze(true);
  const json gone = frames_.wait_for([](const json& f) { return f["board"]["link"] == "gone"; });
  EXPECT_TRUE(gone["runs"].empty());
  running_->freeze(false);
  frames_.wait_for(is_idle);
}

TEST_F(BoardSessionTest, ReconnectsTakenBoardOnRequest) {
  plug_in();
  begin();
  frames_.wait_for(is_idle);
  open_in_another_program();
  frames_.wait_for([](const json& f) { return f["board"]["link"] == "taken"; });
  for (int i = 0; i < 60; ++i) {  // not automatically
    EXPECT_EQ(frames_.wait_for([](const json&) { return true; })["board"]["link"], "taken");
  }
  say({{"do", "connect"}});
  frames_.wait_for(is_idle);
}

TEST_F(BoardSessionTest, ComparesBoardAndDisplayedModel) {
  plug_in();
  begin();
  EXPECT_EQ(frames_.wait_for(is_here)["board"]["model"], "unknown");
  for (const bool same : {true, false}) {
    session_.reset();
    const TestBlob other(sphere(0.02, 0.002));
    client::ModelFile model;
    model.bytes = std::as_bytes(
        std::span(same ? RunningBoard::model().written().bytes : other.written().bytes));
    client::Board(running_->port()).flash(model);
    begin();
    const json frame = frames_.wait_for(is_here);
    EXPECT_EQ(frame["board"]["model"], same ? "same" : "other");
    const std::string about = frame["board"]["about_model"];
    EXPECT_EQ(about.find("tactree flash") == std::string::npos, same) << about;
    // The bound is that of the displayed model.
    EXPECT_EQ(frame["work"]["unit"], "instructions of host");
    EXPECT_EQ(frame["work"]["bound"], same ? json(900.0) : json());
    EXPECT_EQ(frame["work"]["why"].get<std::string>().empty(), same);
  }
}

TEST_F(BoardSessionTest, AppliesParametersAndReportsRefusals) {
  plug_in();
  begin();
  frames_.wait_for(is_here);
  say({{"do", "set"},
       {"stiffness_N_m", 300},
       {"damping_Ns_m", 0.7},
       {"texture_height_m", 2e-4},
       {"force_max_N", 2}});
  const json frame = frames_.wait_for([](const json& f) {
    return f["settings"]["stiffness_N_m"] == 300.0 && f["settings"]["force_max_N"] == 2.0;
  });
  EXPECT_NEAR(frame["settings"]["damping_Ns_m"].get<double>(), 0.7, 1e-6);
  EXPECT_NEAR(frame["settings"]["texture_height_m"].get<double>(), 2e-4, 1e-9);
  say({{"do", "set"}, {"stiffness_N_m", 50000}});
  const json refused = frames_.wait_for([](const json& f) { return f["news"]["number"] == 1; });
  EXPECT_NE(refused["news"]["text"].get<std::string>().find("stiff"), std::string::npos)
      << refused["news"];
  EXPECT_EQ(refused["settings"]["stiffness_N_m"], 300.0);
}

TEST_F(BoardSessionTest, SendsPoseToStoppedBoard) {
  plug_in();
  begin();
  const json pose = {1, 0, 0, 0.01, 0, 1, 0, 0, 0, 0, 1, -0.02, 0, 0, 0, 1};
  const auto is_placed = [](const json& frame) {
    return is_here(frame) && std::abs(frame["place"]["pose"][11].get<double>() + 0.02) < 1e-6;
  };
  arm();
  EXPECT_FALSE(session_->command({{"do", "place"}, {"pose", pose}}));
  (void)while_armed([](const json& frame) {
    return frame["news"]["text"].get<std::string>().starts_with("place: the board is armed");
  });
  EXPECT_FALSE(session_->command({{"do", "stop"}}));
  (void)frames_.wait_for(is_idle);
  EXPECT_FALSE(session_->command({{"do", "place"}, {"pose", pose}}));
  const json placed = frames_.wait_for(is_placed);
  EXPECT_NEAR(placed["bodies"][0][3].get<double>(), 0.01, 1e-6);
  EXPECT_EQ(placed["place"]["scale"], 1.0);
  // The hand presses where the model was.
  const json active = while_armed(is_active);
  EXPECT_FALSE(active["runs"][0]["in_contact"]);
  const json scaled = {{"do", "place"}, {"pose", pose}, {"scale", 2.0}};
  EXPECT_NE(session_->command(scaled).value_or("").find("cannot change the size"),
            std::string::npos);
}

TEST_F(BoardSessionTest, RefusesUnknownCommandsAndSettings) {
  plug_in();
  begin();
  for (const char* command : {"hand", "inject", "clear_injections"}) {
    EXPECT_NE(refusal({{"do", command}}).find("not available with a board"), std::string::npos);
  }
  EXPECT_NE(refusal({{"do", "fly"}}).find("unknown command"), std::string::npos);
  EXPECT_NE(refusal({{"do", 7}}), "accepted");
  EXPECT_NE(refusal({{"do", "set"}, {"device", "premium"}}).find("unknown setting"),
            std::string::npos);
  EXPECT_NE(refusal({{"do", "set"}, {"force_max_N", "much"}}).find("not a number"),
            std::string::npos);
}

TEST_F(BoardSessionTest, TracesEveryTickAsReported) {
  plug_in();
  begin();
  frames_.wait_for([](const json& f) { return f["t_s"].get<double>() > 0.7; });
  const std::string csv = session_->trace_csv();
  EXPECT_GT(std::count(csv.begin(), csv.end(), '\n'), 500);
  const std::string heading = csv.substr(0, csv.find('\n'));
  EXPECT_EQ(heading.find("slipping"), std::string::npos);
  EXPECT_EQ(heading.find("tip_"), std::string::npos);
  EXPECT_NE(heading.find("penetration_m"), std::string::npos);
  EXPECT_EQ(std::count(heading.begin(), heading.end(), ','),
            std::count(csv.begin() + static_cast<std::ptrdiff_t>(heading.size()) + 1,
                       std::find(csv.begin() + static_cast<std::ptrdiff_t>(heading.size()) + 1,
                                 csv.end(), '\n'),
                       ','));
}

TEST_F(BoardSessionTest, RecordsEveryTick) {
  plug_in();
  begin();
  frames_.wait_for(is_here);
  say({{"do", "record"}});
  const double begin_s = frames_.wait_for(is_recording)["t_s"];
  frames_.wait_for([&](const json& f) { return f["t_s"].get<double>() > begin_s + 0.5; });
  EXPECT_EQ(refusal({{"do", "record"}}), "accepted");  // refused by the session's thread
  say({{"do", "end_recording"}});
  const json done =
      frames_.wait_for([](const json& f) { return f["recording"]["state"] == "off"; });
  const std::vector<std::uint32_t> ticks = recorded_ticks();
  EXPECT_GT(ticks.size(), 400U);
  EXPECT_EQ(ticks.back() - ticks.front() + 1U, ticks.size());
  const std::string text = done["recording"]["text"];
  EXPECT_TRUE(text.starts_with(folder_.string())) << text;
  EXPECT_NE(text.find(std::to_string(ticks.size()) + " ticks in"), std::string::npos) << text;
  EXPECT_NE(text.find("none missing"), std::string::npos) << text;
}

TEST_F(BoardSessionTest, CompletesRecordingOfLostBoard) {
  plug_in();
  begin();
  frames_.wait_for(is_here);
  say({{"do", "record"}});
  const double begin_s = frames_.wait_for(is_recording)["t_s"];
  frames_.wait_for([&](const json& f) { return f["t_s"].get<double>() > begin_s + 0.2; });
  running_.reset();
  frames_.wait_for([](const json& f) {
    return f["news"]["text"].get<std::string>().find("the recording ended early. The board") !=
           std::string::npos;
  });
  EXPECT_GT(recorded_ticks().size(), 150U);
  EXPECT_NE(refusal({{"do", "record"}}), "accepted");
}

TEST_F(BoardSessionTest, CompletesRecordingAtItsEnd) {
  plug_in();
  begin();
  frames_.wait_for(is_here);
  say({{"do", "record"}});
  frames_.wait_for(is_recording);
  session_.reset();
  EXPECT_GT(recorded_ticks().size(), 0U);
}

TEST_F(BoardSessionTest, RefusesPortWithoutBoard) {
  const client::PseudoTerminal nobody;
  EXPECT_THROW(BoardSession(bodies(), settings(nobody.name())), client::LinkError);
}

}  // namespace
}  // namespace tactree::test
