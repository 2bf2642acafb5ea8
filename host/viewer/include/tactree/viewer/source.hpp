#pragma once
// Where the motion on the page comes from: a simulation, or a recorded trace.
//
// What goes to and fro are JSON objects. To a page: {"type": "hello", ...} once, then frames at
// display rate, {"type": "frame", ...}, and {"type": "refused", "why": ...} as the answer to a
// command. From a page: {"do": NAME, ...}; each source documents its own.

#include <functional>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

namespace tactree::viewer {

/// Frames a second.
inline constexpr double kFrameRate_hz = 60.0;

class Source {
 public:
  /// Called from the source's own thread; must not block.
  using Publish = std::function<void(std::shared_ptr<const std::string>)>;

  Source() = default;
  Source(const Source&) = delete;
  Source& operator=(const Source&) = delete;
  virtual ~Source() = default;

  /// Begins to move, in a thread of its own, and publishes frames until stop().
  virtual void start(Publish publish) = 0;
  virtual void stop() = 0;

  // From any thread:

  /// What a page must know before its first frame.
  [[nodiscard]] virtual std::string hello() const = 0;
  /// Why the command is refused; nothing when it will be obeyed. Never blocks for long.
  [[nodiscard]] virtual std::optional<std::string> command(const nlohmann::json& command) = 0;
  /// The ticks there are, as simulation::append_trace() writes them.
  [[nodiscard]] virtual std::string trace_csv() const = 0;
};

}  // namespace tactree::viewer
