// Loop and memory annotations: docs/BOUND.md.
// memory: RAM

#include "tactree/core/control/controller.hpp"

namespace tactree::core {

const Output& Controller::step(const Input& input) {
  ++tick_;
  update_bodies(input.bodies);
  force_stage_.add(input.added_force, configuration_);
  const FaultMask present = sense(input);
  if (present != 0U) {
    raise(present);
  }
  const bool was_armed = state_ == State::kArmed;
  execute_command(input, present);
  notice_empty_scene();
  render();
  confirm_arming(input, was_armed);
  report(input, apply_force());
  return output_;
}

void Controller::update_bodies(std::span<const BodyUpdate> updates) {
  for (const BodyUpdate& update : updates) {  // bound: 1
    if (scene_.move(update.body, update.pose, update.motion) == ModelStatus::kOk) {
      force_stage_.allow_stored_energy();
    }
    (void)scene_.enable(update.body, update.enabled);
  }
}

FaultMask Controller::sense(const Input& input) {
  FaultMask faults = monitor_.update(input, configuration_, state_, output_.enable);
  if (!configured_) {
    return faults;
  }
  const bool take_pose = input.command == Command::kHome && motors_off();
  const ProbeSensor::Sensed sensed = sensor_.update(input.encoders, take_pose, configuration_);
  if (sensed.jumped) {
    reset_scene();
  }
  faults |= sensed.faults;
  return faults | watch_encoders(input);
}

// Near the end of a joint's range its stop may hold the axis, whatever its motor does.
FaultMask Controller::watch_encoders(const Input& input) {
  if (state_ != State::kActive || !sensor_.located() || sensor_.pose().reach < 1.0F) {
    monitor_.reset_encoders();
    return 0U;
  }
  const FaultMask stuck =
      monitor_.update_encoders(input.encoders, configuration_, sensor_.pose().effort_per_force,
                               force_stage_.applied_force());
  if (stuck != 0U) {
    sensor_.lose_position(configuration_.device);
  }
  return stuck;
}

void Controller::execute_command(const Input& input, FaultMask present) {
  if (input.command == Command::kNone) {
    return;
  }
  if (input.command == Command::kArm) {
    // Without known joint positions the proxy and the efforts would be wrong.
    if (sensor_.homed()) {
      handle_event(Event::kArm);
    }
  } else if (input.command == Command::kStop) {
    if (state_ == State::kFault && latched_ == 0U) {
      recover();
    } else {
      handle_event(Event::kStop);
    }
  } else if (input.command == Command::kClearFault) {
    latched_ = present;
    handle_event(Event::kClear);
  } else if (input.command == Command::kHome && motors_off()) {
    return;  // handled by sense()
  } else {
    raise(fault_bit(Fault::kUnexpectedEvent));
  }
}

void Controller::recover() {
  handle_event(Event::kRecover);
  if (configured_) {
    handle_event(Event::kConfigured);
  }
  if (!scene_.empty()) {
    handle_event(Event::kModelLoaded);
  }
}

// Updates the proxy in every state, so that a contact is known before the motors are enabled.
void Controller::render() {
  rendered_ = sensor_.located() && !scene_reset_;
  scene_reset_ = false;
  if (!rendered_) {
    return;
  }
  if (state_ != State::kActive) {
    scene_.release_backs();
  }
  const Vec3 probe = sensor_.probe();
  // at most: 1 per Controller::step together scene
  // at most: kAxes per Controller::step together routes as 3
  const SceneRendering& rendering = scene_.update(configuration_, probe, sensor_.velocity());
  if (!rendering.contact.complete) {
    raise(fault_bit(Fault::kModelIncomplete));
  }
}

void Controller::confirm_arming(const Input& input, bool was_armed) {
  if (state_ == State::kActive && configuration_.supervision.dead_man_required && !input.dead_man) {
    handle_event(Event::kUnready);
  }
  if (state_ != State::kArmed || !was_armed) {
    arming_.rest();
    return;
  }
  const SceneRendering& rendering = scene_.rendering();
  const bool is_free = rendered_ && !rendering.contact.in_contact && !rendering.inside;
  const bool device_ready = input.enable_read_back && is_free;
  if (arming_.update(input, configuration_.supervision.dead_man_required, device_ready)) {
    handle_event(Event::kReady);
  }
}

void Controller::handle_event(Event event) {
  const State before = state_;
  state_ = next_state(before, event);
  inverse_ = inverse_of(next_state(before, event));
  if (state_ == State::kFault && before != State::kFault && event != Event::kFault) {
    latched_ |= fault_bit(Fault::kUnexpectedEvent);
  }
  if (state_ == State::kArmed && before != State::kArmed) {
    arming_.begin();
  }
}

void Controller::forget_motion() {
  sensor_.forget_motion();
  reset_scene();
}

// Contacts begin in the next tick: a tick either resets the scene or renders it.
void Controller::reset_scene() {
  scene_.reset(sensor_.probe());  // at most: 1 per Controller::step together scene
  scene_reset_ = true;
}

// The last body may be removed while armed or active: the state changes after the motors are off.
void Controller::notice_empty_scene() {
  if (state_ == State::kIdle && scene_.empty()) {
    handle_event(Event::kModelRemoved);
  }
}

void Controller::raise(FaultMask faults) {
  latched_ |= faults;
  handle_event(Event::kFault);
}

SafetyGate::Result Controller::apply_force() {
  if (state_ != State::kActive) {
    return force_stage_.release();
  }
  const SafetyGate::Result gated = force_stage_.apply(configuration_, sensor_, scene_.rendering());
  if (gated.not_finite) {
    raise(fault_bit(Fault::kNotFinite));
  }
  return gated;
}

void Controller::report(const Input& input, const SafetyGate::Result& gated) {
  output_.motors = gated.command;
  output_.enable = !motors_off();
  Status& status = output_.status;
  status.tick = tick_;
  status.state = state_;
  status.faults = latched_;
  status.limits = gated.limits;
  const Rendering& contact = scene_.rendering().contact;
  const bool at_boundary =
      scene_.rendering().fading || (contact.in_contact && contact.strength < 1.0F);
  status.limits |= state_ == State::kActive && at_boundary ? limit_bit(Limit::kBoundary) : 0U;
  const bool at_end = state_ == State::kActive && contact.in_contact && sensor_.pose().reach < 1.0F;
  status.limits |= at_end ? limit_bit(Limit::kWorkspace) : 0U;
  status.limits |= configured_ && !sensor_.homed() ? limit_bit(Limit::kNotHomed) : 0U;
  status.limits |= scene_.rendering().crowded ? limit_bit(Limit::kBodies) : 0U;
  const bool is_inside = state_ == State::kActive && scene_.rendering().inside;
  status.limits |= arming_.waiting() || is_inside ? limit_bit(Limit::kWaiting) : 0U;
  status.overruns = monitor_.overruns();
  status.probe = sensor_.probe();
  status.velocity = sensor_.velocity();
  status.rendering = contact;
  status.force = gated.force;
  status.added_force = force_stage_.added_force();
  status.gravity_force = gated.gravity_force;
  status.motor_force = gated.motor_force;
  status.load = input.load;
  report_reactions(gated.force - force_stage_.added_force());
  recorder_.add({status.state, status.faults, status.tick, status.probe, status.velocity,
                 status.force, status.rendering, input.load});
}

// Scales the reactions in proportion, because the gate may have reduced the rendered force.
void Controller::report_reactions(Vec3 force) {
  const Vec3 rendered = scene_.rendering().contact.force;
  const float squared = length_squared(rendered);
  const float share = squared > 0.0F ? dot(force, rendered) / squared : 0.0F;
  const bool displayed = share > 0.0F && is_finite(share);
  const float part = share < 1.0F ? share : 1.0F;
  for (std::uint32_t i = 0; i < kMaxReachableBodies; ++i) {  // bound: kMaxReachableBodies
    const Reaction& r = scene_.rendering().reactions[i];
    Reaction& shown = output_.status.reactions[i];
    if (displayed && r.body != kNoBody) {
      shown = {r.body, part * r.force_N, part * r.torque_Nm};
    } else {
      shown = {};
    }
  }
}

}  // namespace tactree::core
