#pragma once
// One tick of the control loop, from encoder counts to motor command:
//   counts -> probe, velocity -> faults, state -> bodies, contact, force -> SafetyGate -> motor
//   command
//
// The result of step(Input) depends on the controller's state and on Input only. Between two ticks
// the state changes only through configure(), adjust(), load_model(), add_body(), remove_body(),
// unload_model() and know_costs(). A replay of all Inputs and of these calls is bit-identical.
//
// Interrupt safety: one context owns a Controller. Another context must hold the ticks
// (between_ticks.hpp) during each call other than state(), motors_off(), homed(), faults(),
// limits(), tick(), has_body() and configuration(). One call of step() is one tick of 1 / rate_hz.
// RAM: sizeof(Controller), at most 28 KiB.

#include <cstdint>
#include <span>

#include "tactree/core/configuration/configuration.hpp"
#include "tactree/core/contact/scene.hpp"
#include "tactree/core/control/admission.hpp"
#include "tactree/core/control/arming.hpp"
#include "tactree/core/control/fault_monitor.hpp"
#include "tactree/core/control/flight_recorder.hpp"
#include "tactree/core/control/force_stage.hpp"
#include "tactree/core/control/probe_sensor.hpp"
#include "tactree/core/control/readings.hpp"
#include "tactree/core/control/state_machine.hpp"
#include "tactree/core/control/tick_cost.hpp"
#include "tactree/core/model/blob.hpp"
#include "tactree/core/safety/faults.hpp"
#include "tactree/core/safety/safety_gate.hpp"

namespace tactree::core {

/// Pose, motion and presence of one body of the scene. Values that Scene::move() refuses are
/// ignored: the body keeps its pose or motion.
struct BodyUpdate {
  std::uint32_t body = kNoBody;  ///< number of the body
  bool enabled = true;
  Pose pose{};
  Motion motion{};
};

/// Complete input of a tick.
struct Input : Readings {
  /// Applied in this order at the start of the tick. hal::Loop passes at most one, and the proven
  /// bound of an image covers one; each additional update costs about 300 instructions.
  std::span<const BodyUpdate> bodies{};
  AddedForce added_force{};
};

/// Result of a tick for telemetry, plots and tests. Positions in the scene's frame, which equals
/// the frame of a model that was not moved.
struct Status {
  std::uint32_t tick = 0;  ///< wraps around
  State state = State::kBoot;
  FaultMask faults = 0;        ///< latched
  LimitMask limits = 0;        ///< active in this tick
  std::uint32_t overruns = 0;  ///< since the start; stays at its maximum
  Vec3 probe{};                ///< m
  Vec3 velocity{};             ///< m/s
  Rendering rendering{};       ///< contact, proxy, normal, force before the limits
  Vec3 force{};                ///< N, output of the gate: contact and added force
  Vec3 added_force{};          ///< N, the application's component of it
  Vec3 gravity_force{};        ///< N at the probe, of the gravity compensation
  /// N at the probe, of everything that the motors are told: force and gravity compensation after
  /// the limits of the axes.
  Vec3 motor_force{};
  float load = 0.0F;  ///< duration of the last tick / period
  /// Reactions to `force` on the bodies in contact.
  Reaction reactions[kMaxReachableBodies]{};
  /// True if a fault is latched or a limit is active.
  [[nodiscard]] bool summary() const { return faults != 0U || limits != 0U; }
};

struct Output {
  MotorCommand motors;
  bool enable = false;  ///< required state of the enable line
  Status status{};
};

/// Parameters that Controller::adjust() changes without homing and loading again.
struct Adjustment {
  // Changeable only while the motors are off.
  ForceLimits limits{};
  LinkSupervision link{};
  bool use_materials = true;
  // Changeable in every state.
  ContactParameters contact{};
};

class Controller {
 public:
  /// Applies a valid configuration while the motors are off; otherwise returns the reason and
  /// changes nothing. Not bounded by a tick.
  [[nodiscard]] ConfigurationStatus configure(const Configuration& configuration);

  /// Current values of the adjustable parameters.
  [[nodiscard]] Adjustment adjustment() const;

  /// Applies an adjustment that passes check(). Returns kBusy if a parameter of the first group
  /// differs while armed or active. A refused adjustment changes nothing. Precondition: configured.
  [[nodiscard]] ConfigurationStatus adjust(const Adjustment& adjustment);

  /// Sets the tick costs of this board and its clock frequency, Hz. From then on the work of a tick
  /// is reduced if its bound would exceed the period, and a model is refused (kTooSlow) if that
  /// does not suffice. While the costs are unknown, no model is refused for its cost. `costs` must
  /// outlive the controller.
  void know_costs(const TickCosts& costs, std::uint32_t cycles_per_second);

  /// True if a tick does less work than its rate allows, because the models are too large for this
  /// board. The proxy may then follow with a longer delay.
  [[nodiscard]] bool work_is_reduced() const {
    return scene_.work_tier() > work_tier_of(configuration_.rate_hz);
  }

  /// Replaces all bodies by one, number 0, at the scene's origin. Requires a model that the mode
  /// can render, and motors off; otherwise returns the reason and keeps the old bodies.
  /// Precondition: configured. The blob must stay unchanged while in use.
  [[nodiscard]] ModelStatus load_model(const BlobView& view);

  /// Adds a body under the conditions of load_model(). `number` receives its number.
  [[nodiscard]] ModelStatus add_body(const BlobView& view, const Pose& pose, std::uint32_t& number);

  /// Removes all bodies. Returns kBusy if armed or active.
  [[nodiscard]] ModelStatus unload_model();

  /// Removes a body in any state; see Scene. Cost: constant.
  [[nodiscard]] ModelStatus remove_body(std::uint32_t number);
  [[nodiscard]] bool has_body(std::uint32_t number) const { return !scene_.view(number).empty(); }

  /// Executes one tick. The result is valid until the next call. Accepts every input.
  /// Cost: Scene::update() and about 1000 instructions.
  const Output& step(const Input& input);

  [[nodiscard]] State state() const { return state_; }
  /// True if both copies of the state are active. Check it before writing a command to the motors:
  /// a single skipped or corrupted instruction in step() may produce a wrong command.
  [[nodiscard]] bool may_give_force() const {
    return state_ == State::kActive && inverse_ == inverse_of(State::kActive);
  }
  [[nodiscard]] FaultMask faults() const { return latched_; }
  /// Limits that were active in the last tick.
  [[nodiscard]] LimitMask limits() const { return output_.status.limits; }
  /// Number of the last tick.
  [[nodiscard]] std::uint32_t tick() const { return tick_; }
  /// True if neither armed nor active.
  [[nodiscard]] bool motors_off() const {
    return state_ != State::kArmed && state_ != State::kActive;
  }
  /// True if the positions of all joints are known.
  [[nodiscard]] bool homed() const { return sensor_.homed(); }
  [[nodiscard]] const Configuration& configuration() const { return configuration_; }
  /// The last ticks, and a snapshot of the first fault.
  [[nodiscard]] const FlightRecorder& recorder() const { return recorder_; }

 private:
  [[nodiscard]] static constexpr std::uint32_t inverse_of(State state) {
    return ~static_cast<std::uint32_t>(state);
  }
  // Changes between ticks.
  [[nodiscard]] ModelStatus may_change_models() const;
  void remove_unsuitable_bodies();
  void choose_work();
  void forget_motion();

  // Steps of a tick, in their order.
  void update_bodies(std::span<const BodyUpdate> updates);
  /// Faults whose cause is present in this tick.
  [[nodiscard]] FaultMask sense(const Input& input);
  [[nodiscard]] FaultMask watch_encoders(const Input& input);
  void execute_command(const Input& input, FaultMask present);
  void notice_empty_scene();
  void render();
  void confirm_arming(const Input& input, bool was_armed);
  [[nodiscard]] SafetyGate::Result apply_force();
  void report(const Input& input, const SafetyGate::Result& gated);
  void report_reactions(Vec3 force);

  void handle_event(Event event);
  void raise(FaultMask faults);
  void recover();
  void reset_scene();

  // Small members first: their offsets fit into the immediate of a load or store.
  State state_ = State::kBoot;
  std::uint32_t inverse_ = inverse_of(State::kBoot);  // complement of state_
  FaultMask latched_ = 0;
  Arming arming_{};
  bool configured_ = false;
  bool scene_reset_ = false;  // in this tick
  bool rendered_ = false;     // in this tick
  std::uint32_t tick_ = 0;
  Output output_{SafetyGate::no_effort()};
  ProbeSensor sensor_{};
  FaultMonitor monitor_{};
  ForceStage force_stage_{};
  Configuration configuration_{};
  Admission admission_{};
  Scene scene_{};
  FlightRecorder recorder_{};
};
static_assert(sizeof(Controller) <= 28U * 1024U, "raise the RAM stated at the top of this header");

}  // namespace tactree::core
