#pragma once
// Fields of the structures of a recording, listed once for writing and reading. `fields` is a
// writer or reader that is called with a reference to each field.

#include "tactree/core/control/controller.hpp"

namespace tactree::simulation {

template <class Fields>
void visit(Fields& fields, core::Vec3& v) {
  fields(v.x);
  fields(v.y);
  fields(v.z);
}

template <class Fields, class T, std::size_t N>
void visit(Fields& fields, T (&values)[N]) {
  for (T& value : values) {
    fields(value);
  }
}

template <class Fields>
void visit(Fields& fields, core::Pose& pose) {
  fields(pose.rotation.w);
  visit(fields, pose.rotation.v);
  visit(fields, pose.translation_m);
}

template <class Fields>
void visit(Fields& fields, core::BodyUpdate& update) {
  fields(update.body);
  fields(update.enabled);
  visit(fields, update.pose);
  visit(fields, update.motion.linear_m_s);
  visit(fields, update.motion.angular_rad_s);
}

template <class Fields>
void visit(Fields& fields, core::AddedForce& force) {
  visit(fields, force.force_N);
  fields(force.ticks);
}

template <class Fields>
void visit(Fields& fields, core::DeviceModel& d) {
  fields(d.kind);
  fields(d.homing);
  visit(fields, d.counts_per_m);
  visit(fields, d.counts_per_revolution);
  visit(fields, d.ratio);
  visit(fields, d.home_count);
  visit(fields, d.home_position);
  visit(fields, d.joint_min);
  visit(fields, d.joint_max);
  visit(fields, d.joint_margin);
  fields(d.arm.arm_m);
  fields(d.arm.forearm_m);
  fields(d.arm.coupling);
  fields(d.delta.a);
  fields(d.delta.b);
  fields(d.delta.c);
  fields(d.delta.d);
  fields(d.delta.e);
  fields(d.delta.f);
  fields(d.delta.r);
  fields(d.delta.s);
  visit(fields, d.delta.leg_rad);
  fields(d.five_bar.arm_m);
  fields(d.five_bar.forearm_m);
  fields(d.five_bar.base_m);
  fields(d.paddle_m);
  visit(fields, d.origin_m);
  visit(fields, d.link_mass_kg);
  visit(fields, d.link_centre_m);
  fields(d.tip_mass_kg);
  visit(fields, d.torque_constant_Nm_per_ampere);
}

template <class Fields>
void visit(Fields& fields, core::ContactParameters& p) {
  fields(p.stiffness_N_m);
  fields(p.damping_Ns_m);
  fields(p.static_friction);
  fields(p.dynamic_friction);
  fields(p.texture_height_m);
  fields(p.texture_wavelength_m);
}

template <class Fields>
void visit(Fields& fields, core::ForceLimits& l) {
  fields(l.force_max_N);
  fields(l.slew_N_s);
  fields(l.ramp_s);
}

template <class Fields>
void visit(Fields& fields, core::MotorLimits& l) {
  visit(fields, l.effort_max);
  visit(fields, l.effort_slew_s);
  fields(l.continuous_share);
  fields(l.thermal_time_s);
  fields(l.signs_proven);
}

template <class Fields>
void visit(Fields& fields, core::Supervision& s) {
  fields(s.speed_max_m_s);
  fields(s.stuck_s);
  fields(s.enable_timeout_s);
  fields(s.dead_man_required);
  fields(s.supply_monitored);
  fields(s.supply_min_V);
  fields(s.supply_max_V);
}

template <class Fields>
void visit(Fields& fields, core::LinkSupervision& l) {
  fields(l.required);
  fields(l.timeout_s);
  fields(l.may_command);
}

template <class Fields>
void visit(Fields& fields, core::Configuration& c) {
  fields(c.rate_hz);
  fields(c.mode);
  visit(fields, c.device);
  visit(fields, c.model_origin_m);
  visit(fields, c.contact);
  fields(c.use_materials);
  fields(c.compensate_gravity);
  fields(c.velocity_cutoff_hz);
  fields(c.passivity_Ns_m);
  fields(c.device_damping_Ns_m);
  fields(c.hand_damping_Ns_m);
  fields(c.delay_s);
  visit(fields, c.limits);
  visit(fields, c.motors);
  visit(fields, c.supervision);
  visit(fields, c.link);
}

template <class Fields>
void visit(Fields& fields, core::Adjustment& a) {
  visit(fields, a.limits);
  visit(fields, a.link);
  fields(a.use_materials);
  visit(fields, a.contact);
}

// If this fails, add the new field to the lists above and increase kRecordingVersion.
static_assert(sizeof(core::Configuration) == 376 && sizeof(core::Adjustment) == 52);

/// First bytes of the file.

/// First byte of each event.
enum class EventKind : std::uint8_t {
  kEnd = 0,
  kModel,
  kConfiguration,
  kLoadModel,
  kAddBody,
  kAdjustment,
  kBeginTrace,
  kTick,
  kRemoveBody,
  kUnloadModel,
};

/// Bits of a tick's mask.
inline constexpr unsigned kCount0 = 1U << 0U;  // and the two bits above it
inline constexpr unsigned kFlags = 1U << 3U;
inline constexpr unsigned kLinkAge = 1U << 4U;
inline constexpr unsigned kOverruns = 1U << 5U;
inline constexpr unsigned kLoad = 1U << 6U;
inline constexpr unsigned kSupply = 1U << 7U;
inline constexpr unsigned kCommand = 1U << 8U;
inline constexpr unsigned kBodies = 1U << 9U;
inline constexpr unsigned kForce = 1U << 10U;
inline constexpr unsigned kIndex = 1U << 11U;
inline constexpr unsigned kStorageBusy = 1U << 12U;  // no data
inline constexpr unsigned kAllTickFields = (1U << 13U) - 1U;

}  // namespace tactree::simulation
