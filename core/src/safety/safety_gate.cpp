// Loop and memory annotations: docs/BOUND.md.
// memory: RAM

#include "tactree/core/safety/safety_gate.hpp"

namespace tactree::core {
namespace {

// Each target is below its limit by more than the rounding error of the operations that follow, so
// that the limits hold exactly: by about 67 roundings of float32, which is 32 uN of 8 N.
constexpr float kInside = 1.0F - 4e-6F;
// Rounding error of last + change, relative to the maximum force or effort.
constexpr float kRounding = 4e-7F;

constexpr bool in_range(float value, float low, float high) {
  return value >= low && value <= high;
}

constexpr float clamp(float value, float limit) {
  return value > limit ? limit : (value < -limit ? -limit : value);
}

/// Length of a finite vector without intermediate overflow; inf if it exceeds the float range.
float safe_length(Vec3 v) {
  const float x = absolute(v.x);
  const float y = absolute(v.y);
  const float z = absolute(v.z);
  const float xy = x > y ? x : y;
  const float largest = xy > z ? xy : z;
  if (!(largest > 0.0F)) {
    return 0.0F;
  }
  // Separate divisions, because 1 / largest overflows for a denormal number.
  const Vec3 scaled = {v.x / largest, v.y / largest, v.z / largest};
  return largest * length(scaled);
}

}  // namespace

bool SafetyGate::configure(const GateLimits& limits) {
  bool valid =
      in_range(limits.force_max_N, 0.01F, 1000.0F) &&
      in_range(limits.slew_N_per_tick, 1e-4F * limits.force_max_N, 2.0F * limits.force_max_N) &&
      limits.ramp_ticks >= 2U && limits.ramp_ticks <= 1000000U &&
      in_range(limits.continuous_share, 0.05F, 1.0F) &&
      in_range(limits.heat_share_per_tick, 1e-8F, 0.1F);
  for (std::uint32_t i = 0; i < kAxes; ++i) {  // bound: kAxes
    valid = valid && in_range(limits.effort_max[i], 1e-4F, 1000.0F) &&
            in_range(limits.effort_slew_per_tick[i], 1e-4F * limits.effort_max[i],
                     2.0F * limits.effort_max[i]);
  }
  if (!valid) {
    return false;
  }
  limits_ = limits;
  heat_.configure(limits.continuous_share, limits.heat_share_per_tick);
  release();
  return true;
}

SafetyGate::Result SafetyGate::release() {
  active_ticks_ = 0;
  last_force_ = {};
  for (float& effort : last_effort_) {  // bound: kAxes
    effort = 0.0F;
  }
  update_thermal_model();
  return {};
}

SafetyGate::Result SafetyGate::command(Vec3 force, const Mat3& effort_per_force, Vec3 own_effort) {
  const bool finite_map = is_finite(effort_per_force.row[0]) &&
                          is_finite(effort_per_force.row[1]) && is_finite(effort_per_force.row[2]);
  if (!is_finite(force) || !finite_map || !is_finite(own_effort)) {
    Result none = release();
    none.not_finite = true;
    return none;
  }
  Result result;
  const bool ramping = active_ticks_ < limits_.ramp_ticks;
  const float gain =
      ramping ? static_cast<float>(active_ticks_) / static_cast<float>(limits_.ramp_ticks) : 1.0F;
  active_ticks_ += ramping ? 1U : 0U;
  result.limits |= ramping ? limit_bit(Limit::kRamp) : 0U;

  const Vec3 ramped = gain * limit_force(force, result.limits);
  result.force = limit_slew(ramped, result.limits);

  const Vec3 wanted = effort_per_force * result.force;
  if (!is_finite(wanted)) {
    Result none = release();
    none.not_finite = true;
    return none;
  }
  limit_axes(gain * own_effort, wanted, result);
  last_force_ = result.force;
  for (std::uint32_t i = 0; i < kAxes; ++i) {  // bound: kAxes
    last_effort_[i] = result.command.effort_[i];
  }
  update_thermal_model();
  return result;
}

void SafetyGate::update_thermal_model() {
  for (std::uint32_t i = 0; i < kAxes; ++i) {  // bound: kAxes
    heat_.add(i, last_effort_[i] / limits_.effort_max[i]);
  }
}

Vec3 SafetyGate::limit_force(Vec3 force, LimitMask& limits) const {
  const float size = safe_length(force);
  const float allowed = kInside * limits_.force_max_N;
  if (size <= allowed) {
    return force;
  }
  limits |= limit_bit(Limit::kForce);
  if (!is_finite(size)) {  // the length overflows; that of half the vector does not
    const Vec3 half = 0.5F * force;
    return (allowed / safe_length(half)) * half;
  }
  const Vec3 direction = {force.x / size, force.y / size, force.z / size};
  return allowed * direction;
}

Vec3 SafetyGate::limit_slew(Vec3 force, LimitMask& limits) const {
  const Vec3 change = force - last_force_;
  const float size = safe_length(change);
  const float allowed = kInside * limits_.slew_N_per_tick - kRounding * limits_.force_max_N;
  if (size <= allowed) {
    return force;
  }
  limits |= limit_bit(Limit::kSlew);
  return last_force_ + (allowed / size) * change;
}

// Gravity compensation has priority within the limit of each axis. The efforts of the force share
// the remainder and are scaled by a common factor, which keeps its direction.
void SafetyGate::limit_axes(Vec3 own, Vec3 wanted, Result& result) const {
  const float base[kAxes] = {own.x, own.y, own.z};
  const float effort[kAxes] = {wanted.x, wanted.y, wanted.z};
  float target[kAxes];
  float share = 1.0F;
  for (std::uint32_t i = 0; i < kAxes; ++i) {  // bound: kAxes
    const float cool = heat_.allowed(i);
    result.limits |= cool < 1.0F ? limit_bit(Limit::kThermal) : 0U;
    const float allowed = kInside * cool * limits_.effort_max[i];
    target[i] = clamp(base[i], allowed);
    result.limits |= target[i] != base[i] ? limit_bit(Limit::kAxis) : 0U;
    const float room = allowed - (effort[i] < 0.0F ? -target[i] : target[i]);
    const float size = absolute(effort[i]);
    if (size * share > room) {
      share = room / size;
    }
  }
  for (std::uint32_t i = 0; i < kAxes; ++i) {  // bound: kAxes
    target[i] += share * effort[i];
  }
  result.limits |= share < 1.0F ? limit_bit(Limit::kAxis) : 0U;
  limit_axis_slew(target, result);
}

void SafetyGate::limit_axis_slew(const float (&target)[kAxes], Result& result) const {
  float share = 1.0F;
  for (std::uint32_t i = 0; i < kAxes; ++i) {  // bound: kAxes
    const float allowed =
        kInside * limits_.effort_slew_per_tick[i] - kRounding * limits_.effort_max[i];
    const float change = absolute(target[i] - last_effort_[i]);
    if (change * share > allowed) {
      share = allowed / change;
    }
  }
  result.limits |= share < 1.0F ? limit_bit(Limit::kAxis) : 0U;
  for (std::uint32_t i = 0; i < kAxes; ++i) {  // bound: kAxes
    const float effort = last_effort_[i] + share * (target[i] - last_effort_[i]);
    result.command.effort_[i] = clamp(effort, kInside * limits_.effort_max[i]);
  }
}

}  // namespace tactree::core
