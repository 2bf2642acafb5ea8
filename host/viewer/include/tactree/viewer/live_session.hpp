#pragma once
// The controller of the firmware in a simulation that keeps pace with the clock on the wall, and a
// hand that the page moves. Both modes may run side by side, each with a device and hand of its
// own that want to go the same way.
//
// Commands of a page:
//   {"do": "hand", "target_m": [x, y, z]}   where the hand wants to be, model frame
//   {"do": "arm"} {"do": "stop"} {"do": "clear"}
//   {"do": "set", "stiffness_N_m": 400, "damping_Ns_m": 0.5, "static_friction": 0.4,
//    "dynamic_friction": 0.3, "rate_hz": 1000, "mode": "surface" | "paper" | "both",
//    "device": NAME, "use_materials": true}  any of them; the session begins anew
//   {"do": "inject", "fault": "encoder1:stuck"}, as --inject without a time: from now on
//   {"do": "mend"}                          everything that was injected

#include <Eigen/Core>
#include <deque>
#include <memory>
#include <mutex>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "tactree/core/device_presets.hpp"
#include "tactree/viewer/frame.hpp"
#include "tactree/viewer/source.hpp"
#include "tactree/viewer/tick_log.hpp"

namespace tactree::viewer {

enum class Modes { kSurface, kPaper, kBoth };
/// "surface", "paper" or "both"; throws SessionRefused.
[[nodiscard]] Modes modes_of(const std::string& name);

/// What a page may change.
struct Settings {
  core::Configuration controller{};  ///< feel and rate; mode, device and place are set from below
  Modes modes = Modes::kSurface;
  std::string device = "premium";
};

struct NamedDevice {
  std::string name;
  std::string about;
  core::DevicePreset figures{};
};

class LiveSession : public Source {
 public:
  /// The blobs that `bodies` view must outlive the session. `devices`: those to choose from.
  /// Throws SessionRefused.
  LiveSession(Bodies bodies, std::vector<NamedDevice> devices, const Settings& settings);
  ~LiveSession() override;

  [[nodiscard]] std::string hello() const override;
  [[nodiscard]] std::optional<std::string> command(const nlohmann::json& command) override;
  [[nodiscard]] std::string trace_csv() const override;

 private:
  struct Run;
  class Hand;
  using Runs = std::vector<std::unique_ptr<Run>>;

  [[nodiscard]] Runs make_runs(const Settings& settings) const;
  [[nodiscard]] simulation::Setup make_setup(const Settings& settings, core::RenderMode mode) const;
  [[nodiscard]] const NamedDevice& device(const std::string& name) const;
  [[nodiscard]] Settings changed(const nlohmann::json& wanted) const;
  [[nodiscard]] nlohmann::json settings_json() const;
  void begin_anew(const nlohmann::json& wanted);
  void enqueue(const nlohmann::json& command);
  void run(const Publish& publish) override;
  void take_over();
  void obey(const nlohmann::json& command);
  void advance(double seconds);
  [[nodiscard]] std::string frame();

  Bodies bodies_;
  std::vector<NamedDevice> devices_;
  Eigen::Vector3d start_m_;  // of the hand: outside the object

  // Of the session's thread.
  Runs runs_;
  std::unique_ptr<Hand> hand_;
  core::CandidateSet scratch_;
  double ticks_due_ = 0.0;
  std::uint64_t frames_ = 0;
  double lost_s_ = 0.0;  // that the machine was too slow to simulate

  mutable std::mutex mutex_;  // guards what follows
  Settings settings_;
  Runs next_runs_;  // of changed settings
  std::deque<nlohmann::json> commands_;

  TickLog log_;
};

}  // namespace tactree::viewer
