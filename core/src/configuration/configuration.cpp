// Loop and memory annotations: docs/BOUND.md.

#include "tactree/core/configuration/configuration.hpp"

namespace tactree::core {
namespace {

constexpr float kMinEffort = 1e-4F;  // N or Nm, of GateLimits

constexpr bool in_bounds(float value, float low, float high) {
  return value >= low && value <= high;
}

/// Keeps the first value that is out of range.
class Checks {
 public:
  void range(ConfigurationStatus status, const char* field, float value, float min, float max,
             std::int32_t axis = -1) {
    refuse(!in_bounds(value, min, max), {status, field, value, min, max, axis});
  }
  void refuse(bool refused, const Refusal& refusal) {
    if (first_.status == ConfigurationStatus::kOk && refused) {
      first_ = refusal;
    }
  }
  [[nodiscard]] const Refusal& first() const { return first_; }

 private:
  Refusal first_{};
};

void check_rendering(const Configuration& c, Checks& checks) {
  using enum ConfigurationStatus;
  const ContactParameters& k = c.contact;
  checks.range(kBadStiffness, "contact.stiffness_N_m", k.stiffness_N_m, 0.0F, 1e5F);
  checks.range(kBadDamping, "contact.damping_Ns_m", k.damping_Ns_m, 0.0F, 1e3F);
  checks.range(kBadDamping, "device_damping_Ns_m", c.device_damping_Ns_m, 0.0F, 1e3F);
  checks.range(kBadDamping, "hand_damping_Ns_m", c.hand_damping_Ns_m, 0.0F, 1e3F);
  checks.range(kBadDamping, "passivity_Ns_m", c.passivity_Ns_m, 0.0F, 100.0F);
  checks.range(kBadFriction, "contact.static_friction", k.static_friction, 0.0F, 2.0F);
  checks.range(kBadFriction, "contact.dynamic_friction", k.dynamic_friction, 0.0F,
               k.static_friction);
  checks.range(kBadTexture, "contact.texture_wavelength_m", k.texture_wavelength_m, 1e-4F, 1.0F);
  const float deepest = 0.5F * k.texture_wavelength_m;
  checks.range(kBadTexture, "contact.texture_height_m", k.texture_height_m, 0.0F,
               deepest < 0.01F ? deepest : 0.01F);
  checks.range(kBadFilter, "velocity_cutoff_hz", c.velocity_cutoff_hz, 1.0F, 0.5F * c.rate_hz);
  const float longest = static_cast<float>(kMaxDelayTicks) / c.rate_hz;
  checks.range(kBadTimeout, "delay_s", c.delay_s, 0.0F, longest < 0.1F ? longest : 0.1F);
  const float stiffest = stability_limit(c).with_hand_N_m;
  checks.refuse(!(k.stiffness_N_m <= stiffest),
                {kUnstable, "contact.stiffness_N_m", k.stiffness_N_m, 0.0F, stiffest});
}

// The gate itself decides; the ranges are those of GateLimits, converted to seconds.
void check_gate(const Configuration& c, Checks& checks) {
  SafetyGate gate;
  if (gate.configure(gate_limits(c))) {
    return;
  }
  const ConfigurationStatus bad = ConfigurationStatus::kBadLimit;
  const auto slew = [&](const char* field, float value, float most, std::int32_t axis = -1) {
    checks.range(bad, field, value, 1e-4F * most * c.rate_hz, 2.0F * most * c.rate_hz, axis);
  };
  checks.range(bad, "limits.force_max_N", c.limits.force_max_N, 0.01F, 1000.0F);
  slew("limits.slew_N_s", c.limits.slew_N_s, c.limits.force_max_N);
  for (std::uint32_t i = 0; i < kAxes; ++i) {  // bound: kAxes
    const auto axis = static_cast<std::int32_t>(i);
    checks.range(bad, "motors.effort_max", c.motors.effort_max[i], 1e-4F, 1000.0F, axis);
    slew("motors.effort_slew_s", c.motors.effort_slew_s[i], c.motors.effort_max[i], axis);
  }
  checks.range(bad, "motors.continuous_share", c.motors.continuous_share, 0.05F, 1.0F);
  checks.range(bad, "motors.thermal_time_s", c.motors.thermal_time_s, 1.0F, 1000.0F);
  checks.refuse(true, {bad, "", 0.0F, 0.0F, 0.0F});  // a rounding error at the end of a range
}

void check_safety(const Configuration& c, Checks& checks) {
  using enum ConfigurationStatus;
  const Supervision& s = c.supervision;
  checks.range(kBadRamp, "limits.ramp_s", c.limits.ramp_s, 2.0F / c.rate_hz, 10.0F);
  if (checks.first().status == kOk) {  // gate_limits() requires a valid ramp_s
    check_gate(c, checks);
  }
  checks.range(kBadSpeed, "supervision.speed_max_m_s", s.speed_max_m_s, 0.1F, 100.0F);
  checks.range(kBadTimeout, "link.timeout_s", c.link.timeout_s, 0.005F, 0.1F);
  checks.refuse(c.link.required && !c.link.may_command, {kBadLink});
  checks.refuse(c.compensate_gravity && !c.motors.signs_proven, {kUnprovenSigns});
  checks.range(kBadTimeout, "supervision.enable_timeout_s", s.enable_timeout_s, 0.001F, 1.0F);
  checks.range(kBadTimeout, "supervision.stuck_s", s.stuck_s, 0.01F, 1.0F);
  if (s.supply_monitored) {
    checks.range(kBadSupply, "supervision.supply_min_V", s.supply_min_V, 1.0F, 1000.0F);
    checks.range(kBadSupply, "supervision.supply_max_V", s.supply_max_V, s.supply_min_V, 1000.0F);
  }
}

constexpr const char* kWords[] = {
    "ok",
    "the controller is armed: stop first",
    "rate_hz is outside 100 .. 20000",
    "mode is neither surface nor paper",
    "a device value is outside its range",
    "model_origin_m is outside +-10 m",
    "stiffness_N_m is outside 0 .. 1e5",
    "a damping is outside 0 .. 1000 Ns/m",
    "friction is outside 0 <= dynamic <= static <= 2",
    "texture is outside 0 <= height <= 0.01 m, wavelength / 2; wavelength 1e-4 .. 1 m",
    "velocity_cutoff_hz is outside 1 .. rate_hz / 2",
    "force, slew or effort limit is outside its range",
    "ramp_s is outside 2 ticks .. 10 s",
    "speed_max_m_s is outside 0.1 .. 100",
    "a timeout or delay is outside its range",
    "supply_min_V or supply_max_V is outside its range",
    "stiffness_N_m is beyond the stability limit of device, hand and rate",
    "a link that is required may only watch",
    "compensate_gravity requires signs_proven",
};
constexpr std::uint32_t kWordCount = sizeof(kWords) / sizeof(kWords[0]);

}  // namespace

const char* describe(ConfigurationStatus status) {
  const auto index = static_cast<std::uint32_t>(status);
  return index < kWordCount ? kWords[index] : "unknown status";
}

Refusal refusal_of(const Configuration& c) {
  using enum ConfigurationStatus;
  Checks checks;
  checks.range(kBadRate, "rate_hz", c.rate_hz, 100.0F, 20000.0F);
  checks.refuse(c.mode != RenderMode::kSurface && c.mode != RenderMode::kPaper, {kBadMode});
  const DeviceRefusal device = refusal_of(c.device);
  checks.refuse(device.field != nullptr,
                {kBadDevice, device.field, device.value, device.min, device.max, device.axis});
  checks.range(kBadOrigin, "model_origin_m.x", c.model_origin_m.x, -10.0F, 10.0F);
  checks.range(kBadOrigin, "model_origin_m.y", c.model_origin_m.y, -10.0F, 10.0F);
  checks.range(kBadOrigin, "model_origin_m.z", c.model_origin_m.z, -10.0F, 10.0F);
  if (checks.first().status == kOk) {  // the further checks require a valid rate
    check_rendering(c, checks);
    check_safety(c, checks);
  }
  return checks.first();
}

Configuration first_force(const Configuration& configuration) {
  Configuration c = configuration;
  const float most = c.limits.force_max_N;
  const float share = most > kFirstForce_N ? kFirstForce_N / most : 1.0F;
  c.limits.force_max_N = share * most;
  c.limits.slew_N_s *= share;
  for (std::uint32_t i = 0; i < kAxes; ++i) {  // bound: kAxes
    const float effort = c.motors.effort_max[i];
    const float reduced = share * effort > kMinEffort ? share * effort : kMinEffort;
    c.motors.effort_slew_s[i] *= reduced / effort;
    c.motors.effort_max[i] = reduced;
  }
  c.compensate_gravity = false;
  c.motors.signs_proven = false;
  return c;
}

StabilityLimit stability_limit(const Configuration& c) {
  const float lag = 0.5F / c.rate_hz + c.delay_s;
  const float own = c.device_damping_Ns_m + c.contact.damping_Ns_m;
  return {own / lag, (own + c.hand_damping_Ns_m) / lag};
}

GateLimits gate_limits(const Configuration& c) {
  GateLimits limits;
  const float period_s = 1.0F / c.rate_hz;
  limits.force_max_N = c.limits.force_max_N;
  limits.slew_N_per_tick = c.limits.slew_N_s * period_s;
  for (std::uint32_t i = 0; i < kAxes; ++i) {  // bound: kAxes
    limits.effort_max[i] = c.motors.effort_max[i];
    limits.effort_slew_per_tick[i] = c.motors.effort_slew_s[i] * period_s;
  }
  limits.continuous_share = c.motors.continuous_share;
  limits.heat_share_per_tick = period_s / c.motors.thermal_time_s;
  limits.ramp_ticks = static_cast<std::uint32_t>(c.limits.ramp_s * c.rate_hz);
  limits.signs_proven = c.motors.signs_proven;
  return limits;
}

}  // namespace tactree::core
