#pragma once
// The source of the motion on the page: a simulation, a recorded trace, or a board.
//
// Messages are JSON objects. To a page: {"type": "hello", ...} once, then frames at display rate,
// {"type": "frame", ...}, and {"type": "refused", "why": ...} in answer to a refused command. From
// a page: {"do": NAME, ...}; each source documents its commands.

#include <atomic>
#include <functional>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>

#include "tactree/web/types.hpp"

namespace tactree::viewer {

inline constexpr double kFrameRate_hz = 60.0;

/// A session cannot start or a command is refused; the message states the cause.
class SessionRefused : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

class Source {
 public:
  /// Called from the source's thread; must not block.
  using Publish = std::function<void(web::Message)>;

  Source() = default;
  Source(const Source&) = delete;
  Source& operator=(const Source&) = delete;
  virtual ~Source() = default;

  /// Starts a thread that publishes frames until stop().
  void start(Publish publish) {
    running_ = true;
    thread_ = std::thread([this, publish = std::move(publish)] { run(publish); });
  }
  /// Ends the thread. Every derived class must call it in its destructor, because the thread uses
  /// its members.
  void stop() {
    running_ = false;
    if (thread_.joinable()) {
      thread_.join();
    }
  }

  // The following functions may be called from any thread.

  /// The message before the first frame.
  [[nodiscard]] virtual std::string hello() const = 0;
  /// Queues a command. Returns the cause if it is refused. Does not block.
  [[nodiscard]] virtual std::optional<std::string> command(const nlohmann::json& command) = 0;
  /// The ticks so far, in the format of simulation::append_trace().
  [[nodiscard]] virtual std::string trace_csv() const = 0;
  /// The border of the device's workspace as reach_json() writes it; "{}" if it is unknown. Slow.
  [[nodiscard]] virtual std::string reach_json() const { return "{}"; }

 protected:
  [[nodiscard]] bool running() const { return running_; }

 private:
  /// Body of the thread: publishes frames while running().
  virtual void run(const Publish& publish) = 0;

  std::atomic<bool> running_{false};
  std::thread thread_;
};

}  // namespace tactree::viewer
