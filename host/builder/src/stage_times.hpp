#pragma once
// Measures the steps of a build: time, points and memory of each.

#include <cstdint>
#include <functional>
#include <string_view>
#include <vector>

#include "tactree/builder/build_model.hpp"
#include "tactree/builder/progress.hpp"

namespace tactree::builder {

/// What a process has used so far.
struct Usage {
  double wall_s = 0.0;
  double cpu_s = 0.0;  ///< of all threads
  std::uint64_t peak_rss_bytes = 0;
};
[[nodiscard]] Usage usage_of_process();

/// Passes the steps on to another Progress, and measures them.
class StageTimes : public Progress {
 public:
  /// `read` returns the usage at the time of the call.
  explicit StageTimes(Progress& progress, std::function<Usage()> read = usage_of_process);

  void begin(std::string_view name) override;
  void advance(double fraction) override { progress_.advance(fraction); }
  void end() override;
  /// Number of points that the current step processes.
  void set_points(std::uint64_t points);

  [[nodiscard]] const std::vector<StageReport>& stages() const { return stages_; }
  /// Seconds since the construction.
  [[nodiscard]] double seconds() const { return read_().wall_s - start_.wall_s; }

 private:
  void close();

  Progress& progress_;
  std::function<Usage()> read_;
  Usage start_;
  Usage begin_;  // of the current step
  bool open_ = false;
  std::vector<StageReport> stages_;
};

}  // namespace tactree::builder
