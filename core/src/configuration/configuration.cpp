// Loop and memory annotations: docs/BOUND.md.

#include "tactree/core/configuration/configuration.hpp"

namespace tactree::core {
namespace {

constexpr bool in_range(float value, float low, float high) {
  return value >= low && value <= high;
}

constexpr bool in_range(Vec3 v, float limit) {
  return in_range(v.x, -limit, limit) && in_range(v.y, -limit, limit) &&
         in_range(v.z, -limit, limit);
}

ConfigurationStatus check_rendering(const Configuration& c) {
  if (!in_range(c.contact.stiffness_N_m, 0.0F, 1e5F)) {
    return ConfigurationStatus::kBadStiffness;
  }
  if (!in_range(c.contact.damping_Ns_m, 0.0F, 1e3F) ||
      !in_range(c.device_damping_Ns_m, 0.0F, 1e3F) || !in_range(c.hand_damping_Ns_m, 0.0F, 1e3F) ||
      !in_range(c.passivity_Ns_m, 0.0F, 100.0F)) {
    return ConfigurationStatus::kBadDamping;
  }
  if (!in_range(c.contact.static_friction, 0.0F, 2.0F) ||
      !in_range(c.contact.dynamic_friction, 0.0F, c.contact.static_friction)) {
    return ConfigurationStatus::kBadFriction;
  }
  if (!in_range(c.velocity_cutoff_hz, 1.0F, 0.5F * c.rate_hz)) {
    return ConfigurationStatus::kBadFilter;
  }
  if (!in_range(c.delay_s, 0.0F, 0.1F)) {
    return ConfigurationStatus::kBadTimeout;
  }
  if (!(c.contact.stiffness_N_m <= stability_limit(c).with_hand_N_m)) {
    return ConfigurationStatus::kUnstable;
  }
  return ConfigurationStatus::kOk;
}

ConfigurationStatus check_safety(const Configuration& c) {
  if (!in_range(c.limits.ramp_s, 2.0F / c.rate_hz, 10.0F)) {
    return ConfigurationStatus::kBadRamp;
  }
  SafetyGate gate;
  if (!gate.configure(gate_limits(c))) {
    return ConfigurationStatus::kBadLimit;
  }
  if (!in_range(c.supervision.speed_max_m_s, 0.1F, 100.0F)) {
    return ConfigurationStatus::kBadSpeed;
  }
  if (!in_range(c.link.timeout_s, 0.005F, 0.1F) ||
      !in_range(c.supervision.enable_timeout_s, 0.001F, 1.0F)) {
    return ConfigurationStatus::kBadTimeout;
  }
  if (!in_range(c.supervision.stuck_s, 0.01F, 1.0F)) {
    return ConfigurationStatus::kBadTimeout;
  }
  const bool supply = in_range(c.supervision.supply_min_V, 1.0F, 1000.0F) &&
                      in_range(c.supervision.supply_max_V, c.supervision.supply_min_V, 1000.0F);
  return c.supervision.supply_monitored && !supply ? ConfigurationStatus::kBadSupply
                                                   : ConfigurationStatus::kOk;
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
    "velocity_cutoff_hz is outside 1 .. rate_hz / 2",
    "force, slew or effort limit is outside its range",
    "ramp_s is outside 2 ticks .. 10 s",
    "speed_max_m_s is outside 0.1 .. 100",
    "a timeout or delay is outside its range",
    "supply_min_V or supply_max_V is outside its range",
    "stiffness_N_m is beyond the stability limit of device, hand and rate",
};
constexpr std::uint32_t kWordCount = sizeof(kWords) / sizeof(kWords[0]);

}  // namespace

const char* describe(ConfigurationStatus status) {
  const auto index = static_cast<std::uint32_t>(status);
  return index < kWordCount ? kWords[index] : "unknown status";
}

ConfigurationStatus check(const Configuration& c) {
  if (!in_range(c.rate_hz, 100.0F, 20000.0F)) {
    return ConfigurationStatus::kBadRate;
  }
  if (c.mode != RenderMode::kSurface && c.mode != RenderMode::kPaper) {
    return ConfigurationStatus::kBadMode;
  }
  if (!is_valid(c.device)) {
    return ConfigurationStatus::kBadDevice;
  }
  if (!in_range(c.model_origin_m, 10.0F)) {
    return ConfigurationStatus::kBadOrigin;
  }
  const ConfigurationStatus rendering = check_rendering(c);
  return rendering != ConfigurationStatus::kOk ? rendering : check_safety(c);
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
  return limits;
}

}  // namespace tactree::core
