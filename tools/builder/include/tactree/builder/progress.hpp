#pragma once
// How far long work has come.

#include <chrono>
#include <cstdio>
#include <memory>
#include <string>
#include <string_view>

namespace tactree::builder {

/// Told by long work where it is. This one keeps quiet.
class Progress {
 public:
  virtual ~Progress() = default;
  /// A step begins; the one before has ended. `name`: a word or two, "reading scan.ply".
  virtual void begin(std::string_view name);
  /// The fraction of the step that is done, 0 to 1.
  virtual void advance(double fraction);
  /// All is done, or has failed: leaves a terminal in order.
  virtual void end();
};

enum class ProgressStyle : std::uint8_t {
  kAuto,   ///< a live line on a terminal, nothing in a pipe
  kPlain,  ///< a line a step
  kJson,   ///< {"step": "reading scan.ply", "fraction": 0.25, "seconds": 1.5} a line
  kOff,
};

/// One that writes to `stream` (a terminal is recognised).
[[nodiscard]] std::unique_ptr<Progress> make_progress(ProgressStyle style, std::FILE* stream);

}  // namespace tactree::builder
