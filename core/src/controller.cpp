// memory: RAM

#include "tactree/core/controller.hpp"

namespace tactree::core {
namespace {

// Two overruns closer than this are a fault.
constexpr std::uint32_t kOverrunWindow = 100;

constexpr std::uint32_t kForever = 0xFFFFFFFFU;

constexpr std::uint32_t add_saturating(std::uint32_t a, std::uint32_t b) {
  return b > kForever - a ? kForever : a + b;
}

/// What one count is for each joint.
Vec3 quantum_of(const DeviceModel& device) {
  float quantum[kAxes] = {0.0F, 0.0F, 0.0F};
  const std::uint32_t axes = axes_of(device.kind);
  for (std::uint32_t i = 0; i < axes; ++i) {  // bound: kAxes
    quantum[i] = 1.0F / absolute(counts_per_unit(device, i));
  }
  return {quantum[0], quantum[1], quantum[2]};
}

}  // namespace

ConfigurationStatus Controller::configure(const Configuration& configuration) {
  if (!motors_off()) {
    return ConfigurationStatus::kBusy;
  }
  const ConfigurationStatus status = check(configuration);
  if (status != ConfigurationStatus::kOk) {
    return status;
  }
  if (!gate_.configure(gate_limits(configuration))) {
    return ConfigurationStatus::kBadLimit;
  }
  configuration_ = configuration;
  configured_ = true;
  link_timeout_ticks_ =
      static_cast<std::uint32_t>(configuration.link_timeout_s * configuration.rate_hz);
  enable_timeout_ticks_ =
      static_cast<std::uint32_t>(configuration.enable_timeout_s * configuration.rate_hz);
  ticks_since_overrun_ = kForever;
  encoder_watch_.configure(
      static_cast<std::uint32_t>(configuration.stuck_s * configuration.rate_hz));
  joint_velocity_.configure(1.0F / configuration.rate_hz, quantum_of(configuration.device),
                            configuration.velocity_cutoff_hz);
  passivity_.configure(1.0F / configuration.rate_hz, configuration.passivity_Ns_m,
                       configuration.delay_s);
  homing_.begin(configuration.device);
  forget_motion();
  happen(Event::kConfigured);
  remove_unsuitable_bodies();
  return ConfigurationStatus::kOk;
}

Adjustment Controller::adjustment() const {
  const Configuration& c = configuration_;
  return {c.force_max_N,    c.slew_N_s,      c.ramp_s,       c.use_materials,   c.link_required,
          c.link_timeout_s, c.stiffness_N_m, c.damping_Ns_m, c.static_friction, c.dynamic_friction};
}

ConfigurationStatus Controller::adjust(const Adjustment& a) {
  const Adjustment now = adjustment();
  const bool limits = a.force_max_N != now.force_max_N || a.slew_N_s != now.slew_N_s ||
                      a.ramp_s != now.ramp_s || a.use_materials != now.use_materials ||
                      a.link_required != now.link_required ||
                      a.link_timeout_s != now.link_timeout_s;
  if (limits && !motors_off()) {
    return ConfigurationStatus::kBusy;
  }
  Configuration c = configuration_;
  c.force_max_N = a.force_max_N;
  c.slew_N_s = a.slew_N_s;
  c.ramp_s = a.ramp_s;
  c.use_materials = a.use_materials;
  c.link_required = a.link_required;
  c.link_timeout_s = a.link_timeout_s;
  c.stiffness_N_m = a.stiffness_N_m;
  c.damping_Ns_m = a.damping_Ns_m;
  c.static_friction = a.static_friction;
  c.dynamic_friction = a.dynamic_friction;
  const ConfigurationStatus status = check(c);
  if (status != ConfigurationStatus::kOk) {
    return status;
  }
  configuration_ = c;
  wall_changed_ = true;
  if (limits) {
    (void)gate_.configure(gate_limits(c));  // check() tried it
    link_timeout_ticks_ = static_cast<std::uint32_t>(c.link_timeout_s * c.rate_hz);
    remove_unsuitable_bodies();
  }
  return ConfigurationStatus::kOk;
}

void Controller::add_force(Vec3 force_N, std::uint32_t ticks) {
  const float squared = length_squared(force_N);
  const float most = kAddedForceShare * configuration_.force_max_N;
  const auto longest = static_cast<std::uint32_t>(kAddedForceSeconds * configuration_.rate_hz);
  given_ticks_ = !is_finite(squared) ? 0U : ticks < longest ? ticks : longest;
  given_ = squared > most * most ? (most / square_root(squared)) * force_N : force_N;
}

// Without one the force keeps its very bits: -0 + 0 is +0.
Vec3 Controller::with_added_force(Vec3 force) {
  if (given_ticks_ == 0U) {
    added_ = {};
    return force;
  }
  --given_ticks_;
  added_ = given_;
  return force + added_;
}

void Controller::know_costs(const TickCosts& costs, std::uint32_t cycles_per_second) {
  costs_ = &costs;
  cycles_per_second_ = cycles_per_second;
}

bool Controller::is_in_time(TickLoad load, const BlobView& added) const {
  if (costs_ == nullptr || costs_->known != kTickCostsKnown) {
    return true;
  }
  load.add(added.header(), configuration_);
  const float period = static_cast<float>(cycles_per_second_) / configuration_.rate_hz;
  return cycles_of(*costs_, load) <= static_cast<std::uint32_t>(period);
}

TickLoad Controller::load_of_scene() const {
  TickLoad load;
  for (std::uint32_t i = 0; i < kMaxBodies; ++i) {  // bound: kMaxBodies
    if (!scene_.view(i).empty()) {
      load.add(scene_.view(i).header(), configuration_);
    }
  }
  return load;
}

void Controller::remove_unsuitable_bodies() {
  TickLoad kept;
  for (std::uint32_t i = 0; i < kMaxBodies; ++i) {  // bound: kMaxBodies
    const BlobView view = scene_.view(i);
    if (view.empty()) {
      continue;
    }
    if (suitability(view) == ModelStatus::kOk && is_in_time(kept, view)) {
      kept.add(view.header(), configuration_);
    } else {
      (void)scene_.remove(i);
    }
  }
  notice_empty_scene();
}

// The last body may be removed while there is force: then the state waits for the motors.
void Controller::notice_empty_scene() {
  if (state_ == State::kIdle && scene_.empty()) {
    happen(Event::kModelRemoved);
  }
}

ModelStatus Controller::suitability(const BlobView& view) const {
  const SurfaceSupport support = surface_support(view);
  if (support == SurfaceSupport::kEmpty) {
    return ModelStatus::kEmpty;
  }
  if (support != SurfaceSupport::kOk && configuration_.mode != RenderMode::kPaper) {
    return support == SurfaceSupport::kNoReach ? ModelStatus::kNoReach
                                               : ModelStatus::kTooManyPoints;
  }
  const bool stable = find_unstable_material(view, configuration_) == kNoMaterial;
  return stable ? ModelStatus::kOk : ModelStatus::kTooStiff;
}

ModelStatus Controller::load_model(const BlobView& view) {
  if (!motors_off()) {
    return ModelStatus::kBusy;
  }
  if (!configured_) {
    return ModelStatus::kNotConfigured;
  }
  const ModelStatus status = suitability(view);
  if (status != ModelStatus::kOk) {
    return status;
  }
  if (!is_in_time({}, view)) {
    return ModelStatus::kTooSlow;
  }
  scene_.clear();
  std::uint32_t number = 0;
  return add_body(view, {}, number);
}

ModelStatus Controller::add_body(const BlobView& view, const Pose& pose, std::uint32_t& number) {
  if (!motors_off()) {
    return ModelStatus::kBusy;
  }
  if (!configured_) {
    return ModelStatus::kNotConfigured;
  }
  ModelStatus status = suitability(view);
  if (status == ModelStatus::kOk && !is_in_time(load_of_scene(), view)) {
    status = ModelStatus::kTooSlow;
  }
  if (status == ModelStatus::kOk) {
    status = scene_.add(view, pose, number);
  }
  if (status == ModelStatus::kOk) {
    forget_motion();
    happen(Event::kModelLoaded);
  }
  return status;
}

ModelStatus Controller::move_body(std::uint32_t number, const Pose& pose, const Motion& motion) {
  const ModelStatus status = scene_.move(number, pose, motion);
  wall_changed_ = wall_changed_ || status == ModelStatus::kOk;
  return status;
}

ModelStatus Controller::enable_body(std::uint32_t number, bool enabled) {
  return scene_.enable(number, enabled);
}

ModelStatus Controller::remove_body(std::uint32_t number) {
  const ModelStatus status = scene_.remove(number);
  notice_empty_scene();
  return status;
}

bool Controller::unload_model() {
  if (!motors_off()) {
    return false;
  }
  scene_.clear();
  forget_motion();
  happen(Event::kModelRemoved);
  return true;
}

const Output& Controller::step(const Input& input) {
  ++tick_;
  FaultMask present = watch(input);
  if (configured_) {
    present |= sense(input);
    present |= watch_stuck(input);
  }
  if (present != 0U) {
    raise(present);
  }
  const bool was_armed = state_ == State::kArmed;
  obey(input, present);
  notice_empty_scene();
  render();
  confirm(input, was_armed);
  const SafetyGate::Result gated = apply_force();
  enable_ = !motors_off();
  output_.motors = gated.command;
  output_.enable = enable_;
  report(gated);
  output_.status.load = input.load;
  record(input, output_.status);
  return output_;
}

// A counter that could not be trusted for a moment has lost its place.
FaultMask Controller::find_joints(const Input& input) {
  const std::uint32_t axes = axes_of(configuration_.device.kind);
  bool valid = true;
  for (std::uint32_t i = 0; i < axes; ++i) {  // bound: kAxes
    valid = valid && input.encoders.valid[i];
  }
  const bool take_pose = input.command == Command::kHome && motors_off();
  if (valid && homing_.update(input.encoders, take_pose, configuration_.device)) {
    return 0U;
  }
  homing_.begin(configuration_.device);
  return fault_bit(Fault::kEncoderInvalid);
}

FaultMask Controller::sense(const Input& input) {
  const FaultMask lost = find_joints(input);
  if (lost != 0U || !homing_.done()) {
    forget_motion();
    return lost;
  }
  pose_ = locate(configuration_.device, input.encoders.counts);
  if (!pose_.valid) {
    forget_motion();
    return fault_bit(Fault::kEncoderInvalid);
  }
  const Vec3 probe = pose_.probe - configuration_.model_origin_m;
  const float furthest = configuration_.speed_max_m_s / configuration_.rate_hz;
  const bool jumped = located_ && !(length_squared(probe - probe_) <= furthest * furthest);
  if (jumped || !located_) {
    joint_velocity_.reset();
    reset_scene(probe);
  }
  probe_ = probe;
  located_ = true;
  // In the joints each count is one step; at the probe the steps of all of them mix.
  velocity_ = transposed_times(pose_.effort_per_force, joint_velocity_.update(pose_.joints));
  if (!jumped) {
    return 0U;
  }
  homing_.begin(configuration_.device);
  return fault_bit(Fault::kEncoderJump);
}

void Controller::forget_motion() {
  located_ = false;
  joint_velocity_.reset();
  velocity_ = {};
  reset_scene(probe_);
}

// The scene begins anew in the next tick: a tick either forgets or renders.
void Controller::reset_scene(Vec3 probe) {
  scene_.reset(probe);  // at most: 1 per Controller::step together scene
  forgot_ = true;
}

FaultMask Controller::watch(const Input& input) {
  FaultMask faults =
      watch_overruns(input) | watch_link(input) | watch_enable(input) | watch_supply(input);
  faults |= input.emergency_stop ? fault_bit(Fault::kEmergencyStop) : 0U;
  faults |= input.motors_ok ? 0U : fault_bit(Fault::kMotorFault);
  return faults;
}

FaultMask Controller::watch_overruns(const Input& input) {
  ticks_since_overrun_ = add_saturating(ticks_since_overrun_, 1);
  if (input.overruns == 0U) {
    return 0U;
  }
  const bool again = input.overruns > 1U || ticks_since_overrun_ <= kOverrunWindow;
  overruns_ = add_saturating(overruns_, input.overruns);
  ticks_since_overrun_ = 0;
  return again ? fault_bit(Fault::kDeadlineMissed) : 0U;
}

FaultMask Controller::watch_link(const Input& input) {
  const std::uint32_t longer = add_saturating(ticks_since_link_, 1);
  const std::uint32_t age = input.link_age_ticks;
  ticks_since_link_ = input.link_alive && age < longer ? age : longer;
  const bool needed = configuration_.link_required && !motors_off();
  return needed && ticks_since_link_ > link_timeout_ticks_ ? fault_bit(Fault::kLinkLost) : 0U;
}

// While there may be force a drop-out counts at once: when the power came back, the force would
// come back with it, without a ramp.
FaultMask Controller::watch_enable(const Input& input) {
  const bool agrees = input.enable_read_back == enable_;
  ticks_of_mismatch_ = agrees ? 0U : add_saturating(ticks_of_mismatch_, 1);
  const bool dropped = state_ == State::kActive && !input.enable_read_back;
  const bool late = configured_ && ticks_of_mismatch_ > enable_timeout_ticks_;
  return dropped || late ? fault_bit(Fault::kEnableMismatch) : 0U;
}

FaultMask Controller::watch_supply(const Input& input) const {
  const bool good = input.supply_V >= configuration_.supply_min_V &&
                    input.supply_V <= configuration_.supply_max_V;
  const bool watched = configuration_.supply_monitored && !motors_off();
  return watched && !good ? fault_bit(Fault::kSupply) : 0U;
}

FaultMask Controller::watch_stuck(const Input& input) {
  if (state_ != State::kActive || !located_) {
    encoder_watch_.reset();
    return 0U;
  }
  const Vec3 effort = pose_.effort_per_force * shown_;
  const float share[kAxes] = {effort.x / configuration_.effort_max[0],
                              effort.y / configuration_.effort_max[1],
                              effort.z / configuration_.effort_max[2]};
  if (encoder_watch_.update(input.encoders.counts, share, axes_of(configuration_.device.kind))) {
    return 0U;
  }
  homing_.begin(configuration_.device);
  return fault_bit(Fault::kEncoderStuck);
}

void Controller::record(const Input& input, const Status& status) {
  recorder_.add({status.state, status.faults, status.tick, status.probe, status.velocity,
                 status.force, status.rendering, input.load});
}

void Controller::obey(const Input& input, FaultMask present) {
  if (input.command == Command::kNone) {
    return;
  }
  if (input.command == Command::kArm) {
    happen(Event::kArm);
  } else if (input.command == Command::kStop) {
    if (state_ == State::kFault && latched_ == 0U) {
      recover();
    } else {
      happen(Event::kStop);
    }
  } else if (input.command == Command::kClearFault) {
    latched_ = present;
    happen(Event::kClear);
  } else if (input.command == Command::kHome && motors_off()) {
    return;  // find_joints() took it
  } else {
    raise(fault_bit(Fault::kUnexpectedEvent));
  }
}

void Controller::recover() {
  happen(Event::kRecover);
  if (configured_) {
    happen(Event::kConfigured);
  }
  if (!scene_.empty()) {
    happen(Event::kModelLoaded);
  }
}

// The proxy follows in every state: when the motors come on, contact is already known.
void Controller::render() {
  rendered_ = located_ && !forgot_;
  forgot_ = false;
  if (!rendered_) {
    return;
  }
  if (state_ != State::kActive) {
    scene_.let_out();
  }
  // at most: 1 per Controller::step together scene
  // at most: kAxes per Controller::step together ways as 3
  const SceneRendering& rendering = scene_.update(configuration_, probe_, velocity_);
  if (!rendering.contact.complete) {
    raise(fault_bit(Fault::kModelIncomplete));
  }
}

void Controller::confirm(const Input& input, bool was_armed) {
  waiting_ = false;
  if (state_ == State::kActive && configuration_.dead_man_required && !input.dead_man) {
    happen(Event::kUnready);
  }
  if (state_ != State::kArmed || !was_armed) {
    return;
  }
  dead_man_released_ = dead_man_released_ || !input.dead_man;
  const bool hand = configuration_.dead_man_required ? input.dead_man && dead_man_released_
                                                     : input.command == Command::kArm;
  const bool device = input.enable_read_back && rendered_ && !scene_.rendering().contact.in_contact;
  waiting_ = hand && !device;
  if (hand && device) {
    happen(Event::kReady);
  }
}

void Controller::happen(Event event) {
  const State before = state_;
  state_ = next_state(before, event);
  inverse_ = inverse_of(next_state(before, event));
  if (state_ == State::kFault && before != State::kFault && event != Event::kFault) {
    latched_ |= fault_bit(Fault::kUnexpectedEvent);
  }
  if (state_ == State::kArmed && before != State::kArmed) {
    dead_man_released_ = false;
  }
}

void Controller::raise(FaultMask faults) {
  latched_ |= faults;
  happen(Event::kFault);
}

// Of the rendered force: what the place of the device allows, and what keeps the wall passive.
// Damping may take the push away, but never pulls the hand into the object. A hand that leaves is
// pushed by no more than the wall can take back in time.
Vec3 Controller::wanted_force() {
  const Rendering& contact = scene_.rendering().contact;
  const Vec3 rendered = pose_.reach * contact.force;
  const bool wall_changed = wall_changed_;
  wall_changed_ = false;
  if (!contact.in_contact || !(configuration_.passivity_Ns_m > 0.0F)) {
    passivity_.reset();
    return rendered;
  }
  const float stored = pose_.reach * contact.stored_energy;
  if (!whole_) {
    passivity_.reset();
    passivity_.allow(stored);
    return rendered;
  }
  if (wall_changed) {
    passivity_.allow(stored);
  }
  const Vec3 wall_velocity = scene_.rendering().wall_velocity;
  const Vec3 added = passivity_.update(shown_ - added_, {probe_, velocity_, wall_velocity}, stored);
  const Vec3 force = rendered + added;
  const float push = dot(force, contact.normal);
  const float leaving = dot(velocity_ - wall_velocity, contact.normal);
  const float most = leaving > 0.0F ? passivity_.most_push(leaving, configuration_.slew_N_s) : push;
  const float pull = dot(rendered, contact.normal);  // of other bodies, at most
  const float least = pull < 0.0F ? pull : 0.0F;
  const float allowed = push < least ? least : push > most ? most : push;
  return allowed == push ? force : force + (allowed - push) * contact.normal;
}

SafetyGate::Result Controller::apply_force() {
  if (state_ != State::kActive) {
    added_ = {};
    given_ticks_ = 0;
    whole_ = false;
    return gate_.release();
  }
  const Vec3 weight = configuration_.compensate_gravity ? pose_.gravity_effort : Vec3{};
  const SafetyGate::Result gated =
      gate_.command(with_added_force(wanted_force()), pose_.effort_per_force, weight);
  shown_ = gated.force;
  whole_ = (gated.limits & limit_bit(Limit::kRamp)) == 0U;
  if (gated.not_finite) {
    raise(fault_bit(Fault::kNotFinite));
  }
  return gated;
}

void Controller::report(const SafetyGate::Result& gated) {
  Status& status = output_.status;
  status.tick = tick_;
  status.state = state_;
  status.faults = latched_;
  status.limits = gated.limits;
  const Rendering& contact = scene_.rendering().contact;
  const bool at_rim = scene_.rendering().fading || (contact.in_contact && contact.strength < 1.0F);
  status.limits |= state_ == State::kActive && at_rim ? limit_bit(Limit::kRim) : 0U;
  const bool at_end = state_ == State::kActive && contact.in_contact && pose_.reach < 1.0F;
  status.limits |= at_end ? limit_bit(Limit::kWorkspace) : 0U;
  status.limits |= configured_ && !homing_.done() ? limit_bit(Limit::kNotHomed) : 0U;
  status.limits |= scene_.rendering().crowded ? limit_bit(Limit::kBodies) : 0U;
  status.limits |= waiting_ ? limit_bit(Limit::kWaiting) : 0U;
  status.overruns = overruns_;
  status.probe = probe_;
  status.velocity = velocity_;
  status.rendering = contact;
  status.force = gated.force;
  report_reactions(gated.force - added_);
}

// The gate may give less than was rendered, or nothing; the bodies take it in proportion.
void Controller::report_reactions(Vec3 force) {
  const Vec3 rendered = scene_.rendering().contact.force;
  const float whole = length_squared(rendered);
  const float share = whole > 0.0F ? dot(force, rendered) / whole : 0.0F;
  const bool displayed = share > 0.0F && is_finite(share);
  const float part = share < 1.0F ? share : 1.0F;
  for (std::uint32_t i = 0; i < kMaxReachableBodies; ++i) {  // bound: kMaxReachableBodies
    const Reaction& r = scene_.rendering().reactions[i];
    Reaction& told = output_.status.reactions[i];
    if (displayed && r.body != kNoBody) {
      told = {r.body, part * r.force_N, part * r.torque_Nm};
    } else {
      told = {};
    }
  }
}

}  // namespace tactree::core
