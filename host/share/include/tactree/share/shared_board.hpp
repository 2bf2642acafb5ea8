#pragma once
// The board that clients share: one connection, whose ticks a thread reports. After a loss of the
// connection it reconnects when the board returns. The board is never armed automatically.

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "tactree/client/board.hpp"
#include "tactree/share/clients.hpp"

namespace tactree::share {

/// The model that the user states to be in use on the board.
struct KnownModel {
  std::string name;
  std::uint32_t points = 0;
  std::size_t bytes = 0;
  std::uint32_t checksum = 0;  ///< CRC-32 of all bytes
};

struct BoardSettings {
  std::string port;
  client::BoardOptions link{};
  std::optional<KnownModel> model{};
  bool arm = false;  ///< before the first client
  /// Prints a line on the terminal. Called from several threads; must not throw.
  std::function<void(const std::string&)> tell;
};

class SharedBoard : public BoardCommands {
 public:
  /// Called from the board's thread; must not block.
  using Publish = std::function<void(const std::vector<Snapshot>&)>;

  /// Connects, and arms if wanted. Throws client::LinkError.
  explicit SharedBoard(BoardSettings settings);
  ~SharedBoard() override;
  SharedBoard(const SharedBoard&) = delete;
  SharedBoard& operator=(const SharedBoard&) = delete;

  [[nodiscard]] const std::string& name() const { return name_; }
  /// Starts the thread. Call it once.
  void start(Publish publish);
  /// Ends the thread.
  void end();

  // For one other thread.
  void add_force(const std::array<float, 3>& force_N) override;
  void stop() override;
  void request(BoardRequest request) override;
  /// Sends a request that changes nothing. `answer` is called from the board's thread, and must not
  /// block; timed_out if the board is not connected.
  using Answer = std::function<void(const client::Response&)>;
  void ask(core::wire::MessageKind kind, std::vector<std::byte> payload, Answer answer);

 private:
  using Clock = std::chrono::steady_clock;

  void begin_session();
  [[nodiscard]] Description describe();
  void add_model(Description& description);
  [[nodiscard]] client::Subscription subscription(const Description& description) const;
  void run();
  void pass();
  void execute_requests();
  void ask_question();
  void execute(BoardRequest request);
  void stop_if_wanted();
  void continue_arming();
  [[nodiscard]] std::vector<Snapshot> take_snapshots();
  void check_link(bool has_news);
  void set_lost(Link link, const std::string& why);
  void wait_for_board();
  void reconnect();
  void report(const std::string& news);

  BoardSettings settings_;
  std::string name_;
  std::mutex connecting_;  // held while reconnecting
  client::Board board_;
  Publish publish_;
  std::atomic<bool> running_ = false;
  std::atomic<bool> stop_wanted_ = false;

  // Used by the board's thread only.
  Snapshot snapshot_;
  bool has_tick_ = false;
  std::uint32_t last_time_us_ = 0;
  std::optional<std::chrono::microseconds> arming_until_;  // time of the connection
  std::chrono::microseconds next_look_{};                  // at the arming
  std::chrono::microseconds last_pass_{};
  std::chrono::microseconds silence_{};  // without telemetry
  bool connect_wanted_ = false;

  struct Question {
    core::wire::MessageKind kind{};
    std::vector<std::byte> payload;
    Answer answer;
  };
  std::mutex mutex_;  // guards requests_ and questions_
  std::deque<BoardRequest> requests_;
  std::deque<Question> questions_;
  std::thread thread_;
};

}  // namespace tactree::share
