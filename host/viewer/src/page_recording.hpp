#pragma once
// The recordings of a board that a page begins and ends. For one thread.

#include <filesystem>
#include <future>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string>

#include "tactree/telemetry/tick_recorder.hpp"
#include "tactree/viewer/board_session.hpp"

namespace tactree::viewer {

class PageRecording {
 public:
  explicit PageRecording(RecordingTarget target) : target_(std::move(target)) {}

  /// Opens a file whose name is not in use yet. Throws support::UserError, also if the preceding
  /// recording is not complete.
  void begin(const telemetry::RecordingOptions& options);
  /// Adds the messages to the recording, if there is one. Ends it if the file cannot be extended.
  void add(std::span<const core::wire::Telemetry> messages);
  /// Ends the recording, if there is one. `why`: cause if the user did not end it. The file is
  /// completed in another thread, because that of a long recording takes seconds.
  void end(const std::string& why = {});
  /// Call it often. Returns the problem of a recording that was completed since the last call, if
  /// it had one.
  [[nodiscard]] std::optional<std::string> update();
  /// Ends the recording and waits until the file is complete.
  void finish();

  /// {"state": "off" | "on" | "completing", "text": file and counts of this or the last recording}
  [[nodiscard]] nlohmann::json to_json() const;

 private:
  struct Outcome {
    std::string text;
    bool has_problem = false;
  };
  [[nodiscard]] static Outcome complete(telemetry::TickRecorder& recorder,
                                        const std::filesystem::path& file, const std::string& why);
  [[nodiscard]] std::optional<std::string> take_outcome();
  [[nodiscard]] std::string text() const;
  void tell(const std::string& text) const;

  RecordingTarget target_;
  std::filesystem::path file_;
  std::unique_ptr<telemetry::TickRecorder> recorder_;  // while it records
  std::future<Outcome> completion_;                    // while the file is completed
  std::string last_;                                   // text of the last recording
};

}  // namespace tactree::viewer
