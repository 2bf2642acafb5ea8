#pragma once
// Simulation of the firmware's controller on a simulated board with a simulated device and hand.
// Deterministic. Not thread safe.

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "tactree/core/control/controller.hpp"
#include "tactree/core/math/crc32.hpp"
#include "tactree/hal/loop.hpp"
#include "tactree/hal/sim/board.hpp"
#include "tactree/plant/device_plant.hpp"
#include "tactree/plant/plant.hpp"
#include "tactree/simulation/hand_path.hpp"
#include "tactree/simulation/injection.hpp"
#include "tactree/simulation/target.hpp"

namespace tactree::simulation {

struct Setup {
  core::Configuration controller{};
  hal::sim::BoardParameters board{};  ///< period_us and rate_hz follow controller.rate_hz
  plant::PlantParameters plant{};     ///< hand and sub-step; the device if `dynamics` is empty
  /// Dynamics of the joints of controller.device. If empty, each axis is plant.device.
  std::optional<core::DeviceDynamics> dynamics{};
  /// False: the counters start at arbitrary counts, and the controller needs Command::kHome. The
  /// user holds the device in its home pose until then, and moves to the path's start afterwards.
  bool homed = true;
};

/// Sets a device for the controller and for the simulated mechanics.
void use_device(const core::DevicePreset& device, Setup& setup);

/// One tick, for traces and plots.
struct Sample {
  double t_s = 0.0;                                 ///< 0 is the first tick after arming
  Eigen::Vector3d tip_m = Eigen::Vector3d::Zero();  ///< true position of the device, model frame
  core::Status status{};
  bool button = false;    ///< of the board's panel: pressed
  bool lamp = false;      ///< of the board's panel: on
  bool has_parts = true;  ///< false: the source does not tell gravity_force and motor_force
};

struct FaultEvent {
  core::Fault fault = core::Fault::kNone;
  std::uint64_t tick = 0;  ///< tick in which it was latched
};

/// Contact of the hand with one body.
struct BodySummary {
  std::uint64_t contact_ticks = 0;
  double force_max_N = 0.0;
  double torque_max_Nm = 0.0;
};

struct Summary {
  std::uint64_t ticks = 0;
  std::uint64_t contact_ticks = 0;
  std::uint64_t overruns = 0;
  double force_max_N = 0.0;
  double force_step_max_N = 0.0;  ///< change in one tick
  double penetration_max_m = 0.0;
  std::uint32_t trace_crc32 = 0;  ///< of the force's three float32 of every tick, little-endian
  std::vector<FaultEvent> faults;
  std::array<BodySummary, core::kMaxBodies> bodies{};  ///< by the controller's body numbers
  std::uint64_t crowded_ticks = 0;  ///< with more bodies within reach than are rendered
};

/// A session with a device that is homed unless the setup says otherwise: power-up, arming, then
/// ticks along the hand's path.
class Simulation {
 public:
  /// `blob` must be 4-byte aligned and outlive the simulation. Throws std::invalid_argument if
  /// the plant's parameters are out of range, and the exceptions of the target.
  Simulation(std::span<const std::byte> blob, const Setup& setup, HandPath path,
             std::unique_ptr<Target> target = std::make_unique<HostTarget>());

  /// Number of ticks that arm() executes.
  [[nodiscard]] static std::uint64_t arming_ticks(const Setup& setup);

  [[nodiscard]] const HandPath& path() const { return path_; }
  /// Result of the start. If it is not ok(), the force stays zero.
  [[nodiscard]] const hal::StartResult& start_result() const { return start_; }

  /// Arms the controller and waits for the end of the ramp, with the hand at rest at the start of
  /// its path. Returns false if the controller is not active then. These ticks are not part of the
  /// trace.
  [[nodiscard]] bool arm();

  /// Sets the faults; their times are those of the samples. Call it before the first step().
  void inject(Injector injector) { injector_ = std::move(injector); }
  [[nodiscard]] Injector& injector() { return injector_; }
  [[nodiscard]] const Injector& injector() const { return injector_; }

  /// Replaces the path by a fixed target of the hand, model frame.
  void steer(const plant::HandTarget& target) { steered_ = target; }

  /// Replaces the simulated device and hand: from now on the encoders read these counts, also
  /// during arm(), and efforts move nothing. The tip of a sample is then the probe.
  void hold_counts(const std::array<double, core::kAxes>& counts) { held_counts_ = counts; }

  /// Number of the next sample; time_s() continues from it.
  [[nodiscard]] std::uint64_t next_tick() const { return ticks_; }
  void go_to(std::uint64_t tick) { ticks_ = tick; }

  /// Sends a command of the application in the next step(). Returns false, and sends nothing, if
  /// the configuration does not let it command; it may always stop.
  [[nodiscard]] bool post(core::Command command);

  /// Executes one tick.
  Sample step();
  /// Executes one tick with the hand at the given time of its path, for a hand that waits or
  /// returns.
  Sample step_with_hand_at(double path_t_s);

  /// Ends the session.
  void finish() { target_->finish(); }

  [[nodiscard]] hal::sim::SimBoard& board() { return board_; }
  /// State of the controller after the last tick.
  [[nodiscard]] core::State state() const { return state_; }
  [[nodiscard]] const plant::DevicePlant& plant() const { return plant_; }
  /// Time of the next sample.
  [[nodiscard]] double time_s() const { return static_cast<double>(ticks_) * period_s_; }

 private:
  void sample_device();
  core::Status tick(double path_t_s);
  [[nodiscard]] plant::HandTarget hand_at(double path_t_s, bool is_homed);

  Setup setup_;
  HandPath path_;
  std::optional<plant::HandTarget> steered_;
  std::optional<std::array<double, core::kAxes>> held_counts_;
  std::optional<Eigen::Vector3d> at_home_m_;  // of the hand, device frame, until it is on its path
  core::Command command_ = core::Command::kNone;
  double period_s_;
  hal::sim::SimBoard board_;
  std::unique_ptr<Target> target_;
  hal::StartResult start_;
  core::State state_ = core::State::kBoot;
  plant::DevicePlant plant_;
  std::uint64_t ticks_ = 0;
  Injector injector_;
};

/// Accumulates samples into a Summary.
class Recorder {
 public:
  void add(const Sample& sample);
  [[nodiscard]] Summary summary() const;

 private:
  void add_reactions(const core::Status& status);

  Summary summary_{};
  core::Crc32 crc_{};
  core::Vec3 last_force_{};
  core::FaultMask known_ = 0;
  bool first_ = true;
};

}  // namespace tactree::simulation
