#pragma once
// The controller of the firmware in a real-time simulation with a hand that the page moves. Both
// modes may run side by side, each with its own device and a hand with the same target.
//
// Commands of a page:
//   {"do": "hand", "target_m": [x, y, z], "via_m": [[x, y, z], ...],
//    "speed_m_s": 0.2}      target of the hand, model frame. Optional: positions on the path to it,
//                           at most 64, and the maximum speed of the hand
//   {"do": "arm"} {"do": "stop"} {"do": "clear"}
//   {"do": "set", "stiffness_N_m": 400, "damping_Ns_m": 0.5, "static_friction": 0.4,
//    "dynamic_friction": 0.3, "rate_hz": 1000, "mode": "surface" | "paper" | "both",
//    "device": NAME, "use_materials": true, "force_max_N": 4, "restart": true}
//                           any subset. The session continues, with its hand and its ticks. An
//                           active controller is stopped and armed again if force_max_N or
//                           use_materials changes; a controller of another mode starts where the
//                           device is. "restart" begins a new session; a change of rate or
//                           device is refused without it
//   {"do": "inject", "fault": "encoder1:stuck"}  like --inject without a time; acts at once
//   {"do": "clear_injections"}              removes all injected faults
//   {"do": "fit"}          scales the model to the workspace of the device: see Fitting
// Frames contain the text for a model that does not fit: {"fit": {"warning": ..., "can_scale":
// false}}; "" if there is none.
// If a command has no visible result, later frames contain a notice with the cause:
// {"news": {"number": 1, "text": ...}}.

#include <Eigen/Core>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "tactree/core/configuration/device_presets.hpp"
#include "tactree/viewer/frame.hpp"
#include "tactree/viewer/source.hpp"
#include "tactree/viewer/tick_log.hpp"

namespace tactree::viewer {

enum class Modes { kSurface, kPaper, kBoth };
/// "surface", "paper" or "both"; throws SessionRefused.
[[nodiscard]] Modes modes_of(const std::string& name);

/// Settings that a page may change.
struct Settings {
  core::Configuration controller{};    ///< contact and rate; the session sets the other fields
  std::optional<float> force_max_N{};  ///< default: that of the device
  Modes modes = Modes::kSurface;
  std::string device = "premium";
};

struct NamedDevice {
  std::string name;
  std::string about;
  core::DevicePreset preset{};
};

/// What a program adds for models that the device does not reach.
struct Fitting {
  /// The text for such a model, none if the device reaches it. Default: never told.
  std::function<std::optional<std::string>(const NamedDevice&)> warning{};
  /// Begins to scale the model for a device; must not block.
  std::function<void(const NamedDevice&)> scale{};
};

class CommandOutcome;
class LiveRun;
class SteeredHand;

class LiveSession : public Source {
 public:
  /// The blobs of `bodies` must outlive the session. `devices` are the choices of the page. Throws
  /// SessionRefused.
  LiveSession(Bodies bodies, std::vector<NamedDevice> devices, const Settings& settings,
              Fitting fitting = {});
  ~LiveSession() override;

  /// Replaces start() in programs with their own time base: executes waiting commands, simulates
  /// the time of one frame as fast as possible, and returns the frame.
  [[nodiscard]] std::string step();

  /// Shows a text on the pages. May be called from any thread, as settings() and warning().
  void report(const std::string& text);
  [[nodiscard]] Settings settings() const;
  /// States that the device does not reach the model or the start of the hand; empty if it does.
  [[nodiscard]] std::string warning() const;

  [[nodiscard]] std::string hello() const override;
  [[nodiscard]] std::optional<std::string> command(const nlohmann::json& command) override;
  [[nodiscard]] std::string trace_csv() const override;

 private:
  using Runs = std::vector<std::unique_ptr<LiveRun>>;

  [[nodiscard]] Runs make_runs(const Settings& settings) const;
  [[nodiscard]] simulation::Setup make_setup(const Settings& settings, core::RenderMode mode) const;
  /// One for each wanted mode. Throws SessionRefused.
  [[nodiscard]] std::vector<simulation::Setup> make_setups(const Settings& settings) const;
  [[nodiscard]] const NamedDevice& device(const std::string& name) const;
  [[nodiscard]] Settings changed(const nlohmann::json& wanted) const;
  [[nodiscard]] nlohmann::json settings_json() const;
  void set(const nlohmann::json& wanted);
  [[nodiscard]] std::string check_fit(const Settings& settings, bool& is_oversize) const;
  void fit() const;
  void enqueue(const nlohmann::json& command);
  void run(const Publish& publish) override;
  void turn(double elapsed_s);
  void apply_commands();
  void change_runs(const Settings& settings);
  void execute(const nlohmann::json& command);
  void for_each_run(void (LiveRun::*act)());
  void inject(const std::string& text);
  void advance(double seconds);
  [[nodiscard]] std::string frame();

  Bodies bodies_;
  std::vector<NamedDevice> devices_;
  Fitting fitting_;
  Eigen::Vector3d start_m_;  // start of the hand, outside the object

  // Used by the session's thread only.
  Runs runs_;
  std::unique_ptr<SteeredHand> hand_;
  std::unique_ptr<CommandOutcome> outcome_;
  core::CandidateSet scratch_;
  double ticks_due_ = 0.0;
  std::uint64_t frames_ = 0;
  double lost_s_ = 0.0;  // real time that was not simulated because the machine was too slow
  std::uint64_t news_number_ = 0;
  std::string news_;

  mutable std::mutex mutex_;  // guards the members up to commands_
  Settings settings_;
  bool is_changed_ = false;  // settings_ differ from those of runs_
  std::string fit_warning_;
  bool is_oversize_ = false;
  Runs next_runs_;  // of a new session; empty if the present one continues
  std::deque<nlohmann::json> commands_;

  TickLog log_;
};

}  // namespace tactree::viewer
