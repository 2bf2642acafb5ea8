#pragma once
// A board as the source: its telemetry, and those controls of the page that the protocol supports.
// After a loss of the connection, the session reconnects when the board returns. The board is never
// armed automatically.
//
// Commands of a page:
//   {"do": "arm"} {"do": "stop"} {"do": "clear"}     like tactree arm, stop, arm --clear
//   {"do": "set", "stiffness_N_m": 400, "damping_Ns_m": 0.5, "static_friction": 0.4,
//    "dynamic_friction": 0.3, "texture_height_m": 2e-4, "texture_wavelength_m": 2e-3,
//    "use_materials": true, "force_max_N": 3}  any subset
//   {"do": "place", "pose": [16 numbers]}  places the model in the frame of the device, while the
//   board
//                                          is stopped
//   {"do": "connect"}                      after another program has taken over the board
//   {"do": "record"} {"do": "end_recording"}  as tactree record: every tick received, in a file of
//                                          this computer. The recording goes on when all pages are
//                                          closed, and ends at the loss of the board
// Frames contain the place of the model as those of a simulation. A board does not report it: it is
// the one that was sent, or that of the model frame. Frames state the recording: {"recording":
// {"state": "on", "text": ...}}. If the board refuses a command, later frames contain a notice:
// {"news": {"number": 1, "text": ...}}.

#include <Eigen/Geometry>
#include <atomic>
#include <chrono>
#include <deque>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string>

#include "tactree/client/board.hpp"
#include "tactree/viewer/frame.hpp"
#include "tactree/viewer/source.hpp"
#include "tactree/viewer/tick_log.hpp"

namespace tactree::viewer {

struct BoardFacts;
class CommandOutcome;
class PageRecording;

/// Where a page records to.
struct RecordingTarget {
  /// Ends with .csv or .npz. If it exists, the name is numbered: recording-2.csv.
  std::filesystem::path file = "recording.csv";
  /// States on the terminal where a recording is, and its counts. Called from the session's thread;
  /// must not throw. May be empty.
  std::function<void(const std::string&)> tell{};
};

struct BoardSettings {
  std::string port;
  client::BoardOptions link{};
  core::DeviceModel device{};          ///< for drawing; boards do not report their device
  std::span<const std::byte> model{};  ///< the displayed model; compared with that of the board
  /// Returns the work per tick of the named board with the displayed model. If empty, the work is
  /// unknown.
  std::function<Work(const std::string& board, const core::wire::CapabilitiesReply& can)> work;
  RecordingTarget recording{};
  /// Of the model, frame of the device; sent in each session. Empty: not sent.
  std::optional<Eigen::Isometry3d> pose{};
};

class BoardSession : public Source {
 public:
  /// Connects; throws client::LinkError. The data that `bodies` and `settings` refer to must
  /// outlive the session.
  BoardSession(Bodies bodies, BoardSettings settings);
  ~BoardSession() override;

  [[nodiscard]] std::string hello() const override;
  [[nodiscard]] std::optional<std::string> command(const nlohmann::json& command) override;
  /// Without the columns that boards do not report: true position of the tip, slipping.
  [[nodiscard]] std::string trace_csv() const override;
  [[nodiscard]] std::string reach_json() const override;

 private:
  using Clock = std::chrono::steady_clock;
  enum class Link { kConnected, kLost, kTaken };

  void begin_session();
  [[nodiscard]] Work work_of(const BoardFacts& facts) const;
  [[nodiscard]] std::uint32_t ticks_per_message(const BoardFacts& facts) const;
  void subscribe();
  void run(const Publish& publish) override;
  void update_board();
  void stop_if_wanted();
  void execute(const nlohmann::json& command);
  void begin_recording();
  void set(const nlohmann::json& wanted);
  void place(const nlohmann::json& command);
  void send_pose();
  void continue_arming();
  void read_telemetry();
  void add(const client::Telemetry& telemetry);
  void check_link();
  void set_lost(Link link, const std::string& why);
  void reconnect();
  void report(const std::string& news);
  [[nodiscard]] std::string frame();
  [[nodiscard]] nlohmann::json run_of_last_tick();
  [[nodiscard]] nlohmann::json settings_json() const;
  [[nodiscard]] nlohmann::json board_json() const;
  [[nodiscard]] nlohmann::json place_json() const;
  [[nodiscard]] std::optional<std::string> post_stop();
  void enqueue(const nlohmann::json& command);

  Bodies bodies_;
  BoardSettings settings_;
  std::atomic<Link> link_ = Link::kConnected;
  std::atomic<bool> stop_wanted_ = false;

  // Used by the session's thread only. post_stop() also uses board_, with connecting_ locked.
  std::mutex connecting_;  // held while reconnecting
  std::unique_ptr<client::Board> board_;
  std::unique_ptr<BoardFacts> facts_;
  core::Configuration sent_{};  // holds the contact parameters sent to the board
  Work work_;
  std::string why_lost_;
  Clock::time_point next_try_{};
  std::optional<std::chrono::microseconds> arming_until_;  // time of the connection
  std::chrono::microseconds last_pass_{};                  // time of the connection
  std::chrono::microseconds silence_{};                    // without telemetry
  std::optional<simulation::Sample> last_;
  std::unique_ptr<CommandOutcome> outcome_;
  std::unique_ptr<PageRecording> recording_;
  client::Subscription subscription_{};
  std::uint32_t last_time_us_ = 0;
  Strip strip_;
  core::CandidateSet scratch_;
  std::uint64_t frames_ = 0;
  std::uint64_t news_number_ = 0;
  std::string news_;

  std::mutex mutex_;  // guards commands_
  std::deque<nlohmann::json> commands_;

  TickLog log_;
};

}  // namespace tactree::viewer
