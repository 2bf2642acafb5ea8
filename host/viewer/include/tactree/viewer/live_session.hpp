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
//    "dynamic_friction": 0.3, "texture_height_m": 2e-4, "texture_wavelength_m": 2e-3,
//    "rate_hz": 1000, "mode": "surface" | "paper" | "both", "device": NAME,
//    "use_materials": true, "force_max_N": 4, "restart": true}
//                           any subset. The session continues, with its hand and its ticks. An
//                           active controller is stopped and armed again if force_max_N or
//                           use_materials changes; a controller of another mode starts where the
//                           device is. "restart" begins a new session; a change of rate or
//                           device is refused without it
//   {"do": "inject", "fault": "encoder1:stuck"}  like --inject without a time; acts at once
//   {"do": "clear_injections"}              removes all injected faults
//   {"do": "place", "pose": [16 numbers], "scale": 1.2, "restart": true}
//                           places the only model in the frame of the device, as a pose file does.
//                           The session continues, unless the scale changes: this begins a new
//                           session and is refused without "restart"
//   {"do": "fit"}          scales and moves the model to the workspace of the device: see Placing
// Frames contain the text for a model that does not fit, after its name: {"fit": {"warning": ...,
// "can_scale": false}}; "" if there is none. If the model can be placed, they contain its place:
// {"place":
// {"pose": [16 numbers], "scale": 1, "origin_m": [x, y, z], "hand_start_m": [x, y, z]}}. The origin
// is that of the model frame in the device frame.
// If a command has no visible result, later frames contain a notice with the cause:
// {"news": {"number": 1, "text": ...}}.

#include <Eigen/Geometry>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "tactree/core/configuration/device_presets.hpp"
#include "tactree/simulation/placement.hpp"
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
  /// Position of the scene's origin in the device frame. Default: simulation::middle_at_origin().
  std::optional<core::Vec3> origin_m{};
  double scale = 1.0;  ///< of the first body, relative to the blob of the user
};

struct NamedDevice {
  std::string name;
  std::string about;
  core::DevicePreset preset{};
};

/// What a program adds for the place of the only model; without `renew`, it cannot be placed.
struct Placing {
  /// The text for a model that the device does not reach, none if it does. The placement is empty
  /// if nobody has placed the model. Default: never told.
  std::function<std::optional<std::string>(const NamedDevice&,
                                           const std::optional<simulation::Placement>&)>
      warning{};
  /// Begins to make the model in the size of a placement, and a new session with it; must not
  /// block.
  std::function<void(const simulation::Placement&)> renew{};
  /// Likewise at a placement that the device reaches; the present one is given.
  std::function<void(const NamedDevice&, const simulation::Placement&)> fit{};
};

class CommandOutcome;
class LiveRun;
class SteeredHand;

class LiveSession : public Source {
 public:
  /// The blobs of `bodies` must outlive the session. `devices` are the choices of the page. Throws
  /// SessionRefused.
  LiveSession(Bodies bodies, std::vector<NamedDevice> devices, const Settings& settings,
              Placing placing = {});
  ~LiveSession() override;

  /// Replaces start() in programs with their own time base: executes waiting commands, simulates
  /// the time of one frame as fast as possible, and returns the frame.
  [[nodiscard]] std::string step();

  /// Shows a text on the pages. May be called from any thread, as settings() and warning().
  void report(const std::string& text);
  [[nodiscard]] Settings settings() const;
  /// States that the device does not reach the first model or the start of the hand; empty if it
  /// does.
  [[nodiscard]] std::string warning() const;

  [[nodiscard]] std::string hello() const override;
  [[nodiscard]] std::optional<std::string> command(const nlohmann::json& command) override;
  [[nodiscard]] std::string trace_csv() const override;
  [[nodiscard]] std::string reach_json() const override;

 private:
  using Runs = std::vector<std::unique_ptr<LiveRun>>;
  using Pose = std::optional<Eigen::Isometry3d>;  // of the first body; empty: as at the start

  [[nodiscard]] Runs make_runs(const Settings& settings, const Pose& placed) const;
  [[nodiscard]] core::Vec3 origin_of(const Settings& settings) const;
  [[nodiscard]] Eigen::Vector3d start_of(const Pose& placed) const;
  [[nodiscard]] simulation::Setup make_setup(const Settings& settings, core::RenderMode mode) const;
  /// One for each wanted mode. Throws SessionRefused.
  [[nodiscard]] std::vector<simulation::Setup> make_setups(const Settings& settings) const;
  [[nodiscard]] const NamedDevice& device(const std::string& name) const;
  [[nodiscard]] Settings changed(const nlohmann::json& wanted) const;
  [[nodiscard]] nlohmann::json settings_json() const;
  void set(const nlohmann::json& wanted);
  struct Fit {
    std::string warning;
    bool is_oversize = false;
  };
  /// Of fit_, beginning with the name of the first model, as on the page its notes do.
  [[nodiscard]] std::string named_warning() const;
  [[nodiscard]] Fit check_fit(const Settings& settings, const Pose& placed) const;
  [[nodiscard]] simulation::Placement placement(const Settings& settings, const Pose& placed) const;
  [[nodiscard]] nlohmann::json place_json() const;
  void place(const nlohmann::json& command);
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

  std::vector<NamedDevice> devices_;
  Placing placing_;
  Eigen::Vector3d above_m_;       // start of the hand, outside the object; frame of the first body
  Eigen::Isometry3d first_pose_;  // of the first body, before anybody places it

  // Used by the session's thread only, except that others read bodies_ with mutex_ locked, and its
  // models, which stay.
  Bodies bodies_;
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
  Pose placed_;              // by the page
  bool is_moved_ = false;    // placed_ differs from the pose in bodies_
  Fit fit_;
  Runs next_runs_;  // of a new session; empty if the present one continues
  std::deque<nlohmann::json> commands_;

  TickLog log_;
};

}  // namespace tactree::viewer
