#pragma once
// Progress of long operations.

#include <chrono>
#include <cstdio>
#include <memory>
#include <string>
#include <string_view>

namespace tactree::builder {

/// Receives the progress of an operation, from one thread. This base class discards it.
class Progress {
 public:
  virtual ~Progress() = default;
  /// Starts a step and ends the previous one. `name` is a word or two, such as "reading scan.ply".
  virtual void begin(std::string_view name);
  /// Sets the completed fraction of the step, 0 to 1.
  virtual void advance(double fraction);
  /// Ends the operation, also after a failure. Clears the progress line of a terminal.
  virtual void end();
};

enum class ProgressStyle : std::uint8_t {
  kAuto,   ///< a line that is updated on a terminal, nothing in a pipe
  kPlain,  ///< one line per step
  kJson,   ///< {"step": "reading scan.ply", "fraction": 0.25, "seconds": 1.5} per line
  kOff,
};

/// The line of a terminal for a step that began `elapsed_s` ago: "reading 25 %, 6 s left".
/// `fraction` is negative if unknown. Without an estimate during the first second.
[[nodiscard]] std::string progress_line(std::string_view name, double fraction, double elapsed_s);

/// A Progress that writes to `stream`.
[[nodiscard]] std::unique_ptr<Progress> make_progress(ProgressStyle style, std::FILE* stream);

}  // namespace tactree::builder
