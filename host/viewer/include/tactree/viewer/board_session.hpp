#pragma once
// A board as the source: what its telemetry tells, and as much of the page's controls as the
// protocol has. A board that is gone is connected again when it comes back; nothing is armed by
// itself.
//
// Commands of a page:
//   {"do": "arm"} {"do": "stop"} {"do": "clear"}     as tactree arm, stop, arm --clear
//   {"do": "set", "stiffness_N_m": 400, "damping_Ns_m": 0.5, "static_friction": 0.4,
//    "dynamic_friction": 0.3, "use_materials": true, "force_max_N": 3}  any of them
//   {"do": "connect"}                                after another program took the board
// What the board refuses is told in the frames that follow: {"news": {"number": 1, "text": ...}}.

#include <atomic>
#include <chrono>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string>

#include "tactree/host/board.hpp"
#include "tactree/viewer/frame.hpp"
#include "tactree/viewer/source.hpp"
#include "tactree/viewer/tick_log.hpp"

namespace tactree::viewer {

struct BoardFacts;

struct BoardSettings {
  std::string port;
  host::BoardOptions link{};
  core::DeviceModel device{};          ///< that is drawn: a board does not tell its own
  std::span<const std::byte> model{};  ///< that is shown: compared with the board's
  /// How much a tick of the board of this name has to do with the model shown; none: not known.
  std::function<Work(const std::string& board, const core::wire::CapabilitiesReply& can)> work;
};

class BoardSession : public Source {
 public:
  /// What `bodies` and `settings` view must outlive the session. Connects; throws host::LinkError.
  BoardSession(Bodies bodies, BoardSettings settings);
  ~BoardSession() override;

  [[nodiscard]] std::string hello() const override;
  [[nodiscard]] std::optional<std::string> command(const nlohmann::json& command) override;
  /// Without what a board does not tell: where the device truly is, and whether it slips.
  [[nodiscard]] std::string trace_csv() const override;

 private:
  using Clock = std::chrono::steady_clock;
  enum class Link { kHere, kGone, kTaken };

  void get_acquainted();
  [[nodiscard]] Work work_of(const BoardFacts& facts) const;
  [[nodiscard]] std::uint32_t ticks_per_message(const BoardFacts& facts) const;
  void run(const Publish& publish) override;
  void use_board();
  void stop_if_wanted();
  void obey(const nlohmann::json& command);
  void set(const nlohmann::json& wanted);
  void go_on_arming();
  void take_telemetry();
  void add(const host::Telemetry& telemetry);
  void notice_loss();
  void lose(Link link, const std::string& why);
  void connect_again();
  void tell(const std::string& news);
  [[nodiscard]] std::string frame();
  [[nodiscard]] nlohmann::json run_of_last_tick();
  [[nodiscard]] nlohmann::json settings_json() const;
  [[nodiscard]] nlohmann::json board_json() const;
  [[nodiscard]] std::optional<std::string> post_stop();
  void enqueue(const nlohmann::json& command);

  Bodies bodies_;
  BoardSettings settings_;
  std::atomic<Link> link_ = Link::kHere;
  std::atomic<bool> stop_wanted_ = false;

  // Of the session's thread, but for what says otherwise.
  std::mutex connecting_;  // held while the board is connected again: then nobody else uses it
  std::unique_ptr<host::Board> board_;
  std::unique_ptr<BoardFacts> facts_;
  core::Configuration feel_{};  // what the board was told of the contact
  Work work_;
  std::string why_not_here_;
  Clock::time_point next_try_{};
  std::optional<Clock::time_point> arming_until_;
  Clock::time_point heard_{};
  std::optional<simulation::Sample> last_;
  std::uint32_t last_time_us_ = 0;
  Strip strip_;
  core::CandidateSet scratch_;
  std::uint64_t frames_ = 0;
  std::uint64_t news_number_ = 0;
  std::string news_;

  std::mutex mutex_;  // guards what follows
  std::deque<nlohmann::json> commands_;

  TickLog log_;
};

}  // namespace tactree::viewer
