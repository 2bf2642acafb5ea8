// Loop and memory annotations: docs/BOUND.md.
// memory: RAM

#include "tactree/core/control/force_stage.hpp"

namespace tactree::core {

bool ForceStage::set_limits(const Configuration& configuration) {
  return gate_.configure(gate_limits(configuration));
}

void ForceStage::configure_passivity(const Configuration& configuration) {
  passivity_.configure(1.0F / configuration.rate_hz, configuration.passivity_Ns_m,
                       configuration.delay_s);
}

void ForceStage::add(const AddedForce& added, const Configuration& configuration) {
  if (added.ticks == 0U) {
    return;
  }
  const float squared = length_squared(added.force_N);
  const float most = kAddedForceShare * configuration.limits.force_max_N;
  const auto longest = static_cast<std::uint32_t>(kAddedForceSeconds * configuration.rate_hz);
  external_ticks_ = !is_finite(squared) ? 0U : added.ticks < longest ? added.ticks : longest;
  external_force_ =
      squared > most * most ? (most / square_root(squared)) * added.force_N : added.force_N;
}

// The rendered force, scaled by the reach of the device and kept passive. Damping may cancel the
// push, but never pulls the hand into the object. The push on a hand that leaves the wall is
// limited to the value that can fall to zero in time: PassivityController::most_push().
Vec3 ForceStage::contact_force(const Configuration& configuration, const ProbeSensor& sensor,
                               const SceneRendering& scene) {
  const Rendering& contact = scene.contact;
  const float reach = sensor.pose().reach;
  const Vec3 rendered = reach * contact.force;
  const bool wall_changed = wall_changed_;
  wall_changed_ = false;
  if (!contact.in_contact || !(configuration.passivity_Ns_m > 0.0F)) {
    passivity_.reset();
    return rendered;
  }
  const float stored = reach * contact.stored_energy;
  if (!ramp_complete_) {
    passivity_.reset();
    passivity_.allow(stored);
    return rendered;
  }
  if (wall_changed) {
    passivity_.allow(stored);
  }
  const Vec3 velocity = sensor.velocity();
  const Vec3 damping = passivity_.update(applied_force_ - added_force_,
                                         {sensor.probe(), velocity, scene.wall_velocity}, stored);
  const Vec3 force = rendered + damping;
  const float push = dot(force, contact.normal);
  const float leaving = dot(velocity - scene.wall_velocity, contact.normal);
  const float most =
      leaving > 0.0F ? passivity_.most_push(leaving, configuration.limits.slew_N_s) : push;
  const float pull = dot(rendered, contact.normal);  // < 0 only by other bodies or a fade
  const float least = pull < 0.0F ? pull : 0.0F;
  const float allowed = push < least ? least : push > most ? most : push;
  return allowed == push ? force : force + (allowed - push) * contact.normal;
}

SafetyGate::Result ForceStage::apply(const Configuration& configuration, const ProbeSensor& sensor,
                                     const SceneRendering& scene) {
  const DevicePose& pose = sensor.pose();
  const Vec3 weight = configuration.compensate_gravity ? pose.gravity_effort : Vec3{};
  Vec3 force = contact_force(configuration, sensor, scene);
  added_force_ = {};
  if (external_ticks_ > 0U) {  // otherwise the addition of 0 would turn -0 into +0
    --external_ticks_;
    added_force_ = external_force_;
    force = force + added_force_;
  }
  const SafetyGate::Result gated = gate_.command(force, pose.effort_per_force, weight);
  applied_force_ = gated.force;
  ramp_complete_ = (gated.limits & limit_bit(Limit::kRamp)) == 0U;
  return gated;
}

SafetyGate::Result ForceStage::release() {
  added_force_ = {};
  external_ticks_ = 0;
  ramp_complete_ = false;
  return gate_.release();
}

}  // namespace tactree::core
