#pragma once
// Where the motion on the page comes from: a simulation, a recorded trace, or a board.
//
// What goes to and fro are JSON objects. To a page: {"type": "hello", ...} once, then frames at
// display rate, {"type": "frame", ...}, and {"type": "refused", "why": ...} as the answer to a
// command. From a page: {"do": NAME, ...}; each source documents its own.

#include <atomic>
#include <functional>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>

namespace tactree::viewer {

/// Frames a second.
inline constexpr double kFrameRate_hz = 60.0;

/// A session that cannot begin, or a command that is not obeyed: why, as words for people.
class SessionRefused : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

class Source {
 public:
  /// Called from the source's own thread; must not block.
  using Publish = std::function<void(std::shared_ptr<const std::string>)>;

  Source() = default;
  Source(const Source&) = delete;
  Source& operator=(const Source&) = delete;
  virtual ~Source() = default;

  /// Begins to move, in a thread of its own, and publishes frames until stop().
  void start(Publish publish) {
    running_ = true;
    thread_ = std::thread([this, publish = std::move(publish)] { run(publish); });
  }
  /// Waits for the thread. A source calls it before any part of it goes.
  void stop() {
    running_ = false;
    if (thread_.joinable()) {
      thread_.join();
    }
  }

  // From any thread:

  /// What a page must know before its first frame.
  [[nodiscard]] virtual std::string hello() const = 0;
  /// Why the command is refused; nothing when it will be obeyed. Never blocks for long.
  [[nodiscard]] virtual std::optional<std::string> command(const nlohmann::json& command) = 0;
  /// The ticks there are, as simulation::append_trace() writes them.
  [[nodiscard]] virtual std::string trace_csv() const = 0;

 protected:
  [[nodiscard]] bool running() const { return running_; }

 private:
  /// The thread: publishes frames while it is running().
  virtual void run(const Publish& publish) = 0;

  std::atomic<bool> running_{false};
  std::thread thread_;
};

}  // namespace tactree::viewer
