#pragma once
// Playback of a trace that `tactree simulate` or a page has written, or of a recording of a board.
//
// Commands of a page:
//   {"do": "seek", "tick": 120}   {"do": "step", "ticks": -1}
//   {"do": "play", "speed": 0.1}  relative to the recorded time; 0 or {"do": "stop"} pauses

#include <filesystem>
#include <mutex>
#include <vector>

#include "tactree/viewer/frame.hpp"
#include "tactree/viewer/source.hpp"

namespace tactree::viewer {

/// The ticks of a trace, CSV or .npz. The columns t_s, probe and force are required; the values of
/// other missing columns are 0. Throws support::CsvError or support::UserError with the text "file:
/// place: cause (hint)".
[[nodiscard]] std::vector<simulation::Sample> read_trace(const std::filesystem::path& file);

class TracePlayback : public Source {
 public:
  /// The blobs of `bodies` must outlive the object. `device` and the position of the model in its
  /// frame are used to draw the linkage. Precondition: !samples.empty().
  TracePlayback(std::vector<simulation::Sample> samples, Bodies bodies,
                const core::DeviceModel& device, const core::Vec3& model_origin_m);
  ~TracePlayback() override;

  [[nodiscard]] std::string hello() const override;
  [[nodiscard]] std::optional<std::string> command(const nlohmann::json& command) override;
  [[nodiscard]] std::string trace_csv() const override;

 private:
  void run(const Publish& publish) override;
  void play(double seconds);
  [[nodiscard]] std::string frame(std::size_t tick, double speed);
  [[nodiscard]] nlohmann::json around(std::size_t tick) const;

  std::vector<simulation::Sample> samples_;
  Bodies bodies_;
  core::DeviceModel device_;
  core::Vec3 model_origin_m_;
  core::CandidateSet scratch_;

  mutable std::mutex mutex_;  // guards the members below
  std::size_t tick_ = 0;
  double speed_ = 0.0;
  double time_s_ = 0.0;  // during playback
};

}  // namespace tactree::viewer
