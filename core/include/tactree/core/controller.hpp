#pragma once
// One tick of the control loop, from encoder counts to motor command:
//   counts -> probe, velocity -> faults, state -> bodies, contact, force -> SafetyGate -> motor
//   command
//
// Interrupt safe as a whole: one context owns a Controller; nothing is shared. Time is an input:
// one call of step() is one tick of 1 / rate_hz. RAM: sizeof(Controller), about 9 KiB.

#include <cstdint>

#include "tactree/core/blob.hpp"
#include "tactree/core/configuration.hpp"
#include "tactree/core/encoder_watch.hpp"
#include "tactree/core/faults.hpp"
#include "tactree/core/flight_recorder.hpp"
#include "tactree/core/homing.hpp"
#include "tactree/core/passivity.hpp"
#include "tactree/core/safety_gate.hpp"
#include "tactree/core/scene.hpp"
#include "tactree/core/state_machine.hpp"
#include "tactree/core/tick_cost.hpp"
#include "tactree/core/velocity.hpp"

namespace tactree::core {

/// At most one command a tick.
enum class Command : std::uint8_t {
  kNone = 0,
  kArm,
  kStop,
  kClearFault,
  kHome,  ///< the device is in its home pose; for HomingMethod::kGivenPose, motors off
};

struct Input {
  EncoderReading encoders{};
  bool emergency_stop = true;     ///< true: pressed, or its wire is open
  bool dead_man = false;          ///< true: held
  bool enable_read_back = false;  ///< true: the amplifiers have power
  bool motors_ok = false;         ///< false: the motor bank reports a failure
  bool link_alive = false;        ///< a valid message came in since the last tick
  /// Where link_alive: for how long the host may have been gone when it came in. A message that
  /// was long on its way is a weak sign of life.
  std::uint16_t link_age_ticks = 0;
  std::uint32_t overruns = 0;  ///< deadlines missed since the last tick
  float load = 0.0F;           ///< share of the period that the last tick took
  float supply_V = 0.0F;       ///< of the amplifiers; where Configuration::supply_monitored
  Command command = Command::kNone;
};

/// What a tick did: for telemetry, plots and tests. Positions in the scene's frame, which is that
/// of a model which was not moved.
struct Status {
  std::uint32_t tick = 0;  ///< wraps around
  State state = State::kBoot;
  FaultMask faults = 0;        ///< latched
  LimitMask limits = 0;        ///< that held the force back in this tick
  std::uint32_t overruns = 0;  ///< since the start; stays at its maximum
  Vec3 probe{};                ///< m
  Vec3 velocity{};             ///< m/s
  Rendering rendering{};       ///< contact, proxy, normal, force wanted
  Vec3 force{};                ///< N, after the gate: what the hand is to feel
  float load = 0.0F;           ///< share of the period that the last tick took
  /// Of the force that the hand feels, on the bodies in contact.
  Reaction reactions[kMaxReachableBodies]{};
  /// Non-zero exactly when a fault is latched or a limit acts.
  [[nodiscard]] bool summary() const { return faults != 0U || limits != 0U; }
};

struct Output {
  MotorCommand motors;
  bool enable = false;  ///< what the enable line must be
  Status status{};
};

/// What may change without homing and loading anew: see Controller::adjust().
struct Adjustment {
  // Only while the motors are off.
  float force_max_N = 0.0F;
  float slew_N_s = 0.0F;
  float ramp_s = 0.0F;
  bool use_materials = true;
  bool link_required = false;
  float link_timeout_s = 0.0F;
  // Also while there is force.
  float stiffness_N_m = 0.0F;
  float damping_Ns_m = 0.0F;
  float static_friction = 0.0F;
  float dynamic_friction = 0.0F;
};

/// Longest that a force of the application acts without being given again, and its share of
/// force_max_N.
inline constexpr float kAddedForceSeconds = 0.1F;
inline constexpr float kAddedForceShare = 0.5F;

class Controller {
 public:
  /// Takes a configuration when it is valid and the motors are off; else changes nothing.
  [[nodiscard]] ConfigurationStatus configure(const Configuration& configuration);

  /// The configuration's figures of an Adjustment, as they are now.
  [[nodiscard]] Adjustment adjustment() const;

  /// Takes them, by the rules of check(); kBusy where one of the first part would change while
  /// armed or active. Else changes nothing. Precondition: configured.
  [[nodiscard]] ConfigurationStatus adjust(const Adjustment& adjustment);

  /// Adds a force of the application to that of the contact for so many ticks, until the next one
  /// is given, or until it is not active any more. Longer than kAddedForceShare of force_max_N it
  /// is scaled down; for longer than kAddedForceSeconds it does not act; one that is not finite is
  /// none. The gate limits the sum as any force.
  void add_force(Vec3 force_N, std::uint32_t ticks);

  /// What a tick costs on this board, of so many cycles a second: from now on a model is refused
  /// (kTooSlow) when a tick with it may take longer than a period. Costs that are not known refuse
  /// nothing. `costs` must outlive the controller.
  void know_costs(const TickCosts& costs, std::uint32_t cycles_per_second);

  /// Makes a model the only body, number 0, at the scene's origin, when the mode can render it and
  /// the motors are off; else keeps the old ones.
  /// Precondition: configured. The blob must outlive its use and not change.
  [[nodiscard]] ModelStatus load_model(const BlobView& view);

  /// Adds a body to those that are there, on the same conditions. `number` tells which it is.
  [[nodiscard]] ModelStatus add_body(const BlobView& view, const Pose& pose, std::uint32_t& number);

  /// Gives all models up; refused (false) while armed or active.
  [[nodiscard]] bool unload_model();

  // At any time, also while there is force; see Scene. Cost: constant.
  [[nodiscard]] ModelStatus move_body(std::uint32_t number, const Pose& pose, const Motion& motion);
  [[nodiscard]] ModelStatus enable_body(std::uint32_t number, bool enabled);
  [[nodiscard]] ModelStatus remove_body(std::uint32_t number);
  [[nodiscard]] bool has_body(std::uint32_t number) const { return !scene_.view(number).empty(); }

  /// One tick; what it returns holds until the next. Accepts every input. Cost: Scene::update() and
  /// some 1000 instructions.
  const Output& step(const Input& input);

  [[nodiscard]] State state() const { return state_; }
  /// Is the state active, by two records of it? For a last look before a command goes to the
  /// motors: where one instruction of step() fails, as a core's does in a glitch, its command may
  /// be wrong.
  [[nodiscard]] bool may_give_force() const {
    return state_ == State::kActive && inverse_ == inverse_of(State::kActive);
  }
  [[nodiscard]] FaultMask faults() const { return latched_; }
  /// Neither armed nor active.
  [[nodiscard]] bool motors_off() const {
    return state_ != State::kArmed && state_ != State::kActive;
  }
  /// Are the joints' positions known?
  [[nodiscard]] bool homed() const { return homing_.done(); }
  [[nodiscard]] const Configuration& configuration() const { return configuration_; }
  /// The last ticks, and the one in which the first fault was latched.
  [[nodiscard]] const FlightRecorder& recorder() const { return recorder_; }

 private:
  [[nodiscard]] static constexpr std::uint32_t inverse_of(State state) {
    return ~static_cast<std::uint32_t>(state);
  }
  [[nodiscard]] FaultMask sense(const Input& input);
  [[nodiscard]] FaultMask find_joints(const Input& input);
  [[nodiscard]] FaultMask watch(const Input& input);
  [[nodiscard]] FaultMask watch_overruns(const Input& input);
  [[nodiscard]] FaultMask watch_link(const Input& input);
  [[nodiscard]] FaultMask watch_enable(const Input& input);
  [[nodiscard]] FaultMask watch_supply(const Input& input) const;
  [[nodiscard]] FaultMask watch_stuck(const Input& input);
  void record(const Input& input, const Status& status);
  /// `present`: causes of faults there in this tick.
  void obey(const Input& input, FaultMask present);
  void render();
  void confirm(const Input& input, bool was_armed);
  void happen(Event event);
  void raise(FaultMask faults);
  void recover();
  void forget_motion();
  void reset_scene(Vec3 probe);
  [[nodiscard]] ModelStatus suitability(const BlobView& view) const;
  [[nodiscard]] bool is_in_time(TickLoad load, const BlobView& added) const;
  [[nodiscard]] TickLoad load_of_scene() const;
  void remove_unsuitable_bodies();
  void notice_empty_scene();
  [[nodiscard]] Vec3 wanted_force();
  [[nodiscard]] Vec3 with_added_force(Vec3 force);
  SafetyGate::Result apply_force();
  void report(const SafetyGate::Result& gated);
  void report_reactions(Vec3 force);

  const TickCosts* costs_ = nullptr;
  std::uint32_t cycles_per_second_ = 0;
  Configuration configuration_{};
  State state_ = State::kBoot;
  std::uint32_t inverse_ = inverse_of(State::kBoot);  // of state_, to compare it with
  FaultMask latched_ = 0;
  bool waiting_ = false;  // armed, and not yet allowed to be active

  DevicePose pose_{};
  Vec3 probe_{};
  bool located_ = false;   // probe_ is of the last tick
  bool forgot_ = false;    // the scene was reset in this tick
  bool rendered_ = false;  // it was updated in this tick
  Homing homing_{};
  VelocityEstimator joint_velocity_{};
  Vec3 velocity_{};  // of the probe, m/s
  Scene scene_{};
  PassivityController passivity_{};
  Vec3 shown_{};  // force of the last active tick, N
  Vec3 added_{};  // the application's share of it, N
  Vec3 given_{};  // as add_force() took it, N
  std::uint32_t given_ticks_ = 0;
  bool whole_ = false;         // that force was not held back by the ramp
  bool wall_changed_ = false;  // by the application, since the last tick
  SafetyGate gate_{};
  EncoderWatch encoder_watch_{};
  FlightRecorder recorder_{};

  std::uint32_t tick_ = 0;
  std::uint32_t overruns_ = 0;
  std::uint32_t ticks_since_overrun_ = 0;
  std::uint32_t ticks_since_link_ = 0;
  std::uint32_t ticks_of_mismatch_ = 0;
  std::uint32_t link_timeout_ticks_ = 0;
  std::uint32_t enable_timeout_ticks_ = 0;
  bool configured_ = false;
  bool enable_ = false;
  bool dead_man_released_ = false;  // since arming: a control tied down does not count
  Output output_{SafetyGate::no_effort()};
};

}  // namespace tactree::core
