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

// N or Nm: a smaller value changes nothing, and its reciprocal may overflow.
constexpr float kNothing = 1e-30F;

/// Length of a finite vector without intermediate overflow; inf if it exceeds the float range, 0
/// for a vector of at most kNothing.
float safe_length(Vec3 v) {
  const float x = absolute(v.x);
  const float y = absolute(v.y);
  const float z = absolute(v.z);
  const float xy = x > y ? x : y;
  const float largest = xy > z ? xy : z;
  if (!(largest > kNothing)) {
    return 0.0F;
  }
  return largest * length((1.0F / largest) * v);
}

/// The factor that reduces `size` to `allowed`; 0 if `size` is infinite or NaN.
float factor_to(float allowed, float size) {
  if (size <= allowed) {
    return 1.0F;
  }
  const float share = allowed / size;
  return share > 0.0F ? share : 0.0F;
}

}  // namespace

/// Forces at the probe that efforts cause in one pose.
class ProbeForce {
 public:
  ProbeForce(const Mat3& effort_per_force, bool signs_proven)
      : per_effort_(force_per_effort(effort_per_force)), signs_proven_(signs_proven) {
    if (!signs_proven_) {
      alone_ = {length(per_effort_.row[0]), length(per_effort_.row[1]), length(per_effort_.row[2])};
    }
  }

  struct Forces {
    Vec3 sum{};              // N, with proven signs
    float largest_N = 0.0F;  // that they can cause; convex in the efforts; not finite if singular
  };
  [[nodiscard, gnu::noinline]] Forces of(Vec3 efforts) const {
    const Vec3 sum = transposed_times(per_effort_, efforts);
    return {sum, signs_proven_ ? length(sum)
                               : alone_.x * absolute(efforts.x) + alone_.y * absolute(efforts.y) +
                                     alone_.z * absolute(efforts.z)};
  }

 private:
  Mat3 per_effort_;
  Vec3 alone_{};  // N per N or Nm: magnitude of the force of each axis
  bool signs_proven_;
};

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
  const ProbeForce at_probe(effort_per_force, limits_.signs_proven);
  limit_axes(gain * own_effort, wanted, at_probe, result);
  limit_motor_force(at_probe, result);
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
  return allowed * ((1.0F / size) * force);
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

// Gravity compensation has priority within the limits of the axes and of the force. The efforts of
// the force share the remainder and are scaled by a common factor, which keeps its direction.
void SafetyGate::limit_axes(Vec3 own, Vec3 wanted, const ProbeForce& at_probe,
                            Result& result) const {
  const float base[kAxes] = {own.x, own.y, own.z};
  const float effort[kAxes] = {wanted.x, wanted.y, wanted.z};
  float allowed[kAxes];
  float target[kAxes];
  for (std::uint32_t i = 0; i < kAxes; ++i) {  // bound: kAxes
    const float cool = heat_.allowed(i);
    result.limits |= cool < 1.0F ? limit_bit(Limit::kThermal) : 0U;
    allowed[i] = kInside * cool * limits_.effort_max[i];
    target[i] = clamp(base[i], allowed[i]);
    result.limits |= target[i] != base[i] ? limit_bit(Limit::kAxis) : 0U;
  }
  float gravity_N = 0.0F;
  const Vec3 gravity =
      limit_gravity({target[0], target[1], target[2]}, at_probe, result, gravity_N);
  target[0] = gravity.x;
  target[1] = gravity.y;
  target[2] = gravity.z;
  float share = 1.0F;
  for (std::uint32_t i = 0; i < kAxes; ++i) {  // bound: kAxes
    const float room = allowed[i] - (effort[i] < 0.0F ? -target[i] : target[i]);
    const float size = absolute(effort[i]);
    if (size * share > room) {
      share = room / size;
    }
  }
  result.limits |= share < 1.0F ? limit_bit(Limit::kAxis) : 0U;
  const float with = at_probe.of(gravity + share * wanted).largest_N;
  share *= share_of_force(gravity_N, with, result.limits);
  for (std::uint32_t i = 0; i < kAxes; ++i) {  // bound: kAxes
    target[i] += share * effort[i];
  }
  limit_axis_slew(target, result);
}

// `size_N`: the largest force of what is kept.
Vec3 SafetyGate::limit_gravity(Vec3 efforts, const ProbeForce& at_probe, Result& result,
                               float& size_N) const {
  const float allowed = kInside * limits_.force_max_N;
  const ProbeForce::Forces forces = at_probe.of(efforts);
  const float share = factor_to(allowed, forces.largest_N);
  result.limits |= share < 1.0F ? limit_bit(Limit::kForce) : 0U;
  if (!(share > 0.0F)) {
    return {};
  }
  size_N = share < 1.0F ? allowed : forces.largest_N;
  result.gravity_force = share * forces.sum;
  return share * efforts;
}

// The factor s of the added efforts with which the force stays within the limit. The force is
// convex in s, so it is at most the chord between its values at s = 0 (`without`) and s = 1
// (`with`).
float SafetyGate::share_of_force(float without, float with, LimitMask& limits) const {
  const float allowed = kInside * limits_.force_max_N;
  if (with <= allowed) {
    return 1.0F;
  }
  limits |= limit_bit(Limit::kForce);
  const float share = (allowed - without) / (with - without);
  return share > 0.0F ? share : 0.0F;  // 0 also for NaN
}

// The efforts of the last tick, from which the slew limit starts, may have a larger force in the
// present pose.
void SafetyGate::limit_motor_force(const ProbeForce& at_probe, Result& result) const {
  float(&effort)[kAxes] = result.command.effort_;
  const ProbeForce::Forces forces = at_probe.of({effort[0], effort[1], effort[2]});
  const float share = factor_to(kInside * limits_.force_max_N, forces.largest_N);
  if (share < 1.0F) {
    result.limits |= limit_bit(Limit::kForce);
    for (float& one : effort) {  // bound: kAxes
      one *= share;
    }
  }
  if (share > 0.0F) {
    result.motor_force = share * forces.sum;
  }
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
