// Loop and memory annotations: docs/BOUND.md.
// memory: RAM

#include "tactree/core/control/passivity.hpp"

namespace tactree::core {

void PassivityController::configure(float period_s, float damping_max_Ns_m, float delay_s) {
  constexpr float kMax = static_cast<float>(kMaxDelayTicks);
  period_s_ = period_s;
  damping_max_ = damping_max_Ns_m;
  delay_s_ = delay_s;
  const float ticks = delay_s < kMax * period_s ? delay_s / period_s : kMax;
  whole_ticks_ = static_cast<std::uint32_t>(ticks);
  rest_ = ticks - static_cast<float>(whole_ticks_);
  reset();
}

void PassivityController::reset() {
  absorbed_energy_ = 0.0F;
  if (!following_) {
    return;  // unchanged since the last reset
  }
  observed_energy_ = 0.0F;
  stored_ = 0.0F;
  following_ = false;
  for (Vec3& force : sent_) {  // bound: kHistory
    force = {};
  }
}

void PassivityController::allow(float stored) {
  if (absorbed_energy_ < stored) {
    absorbed_energy_ = stored;
  }
}

/// Mean force at the hand since the last tick.
Vec3 PassivityController::acted() const {
  const Vec3 newer = sent_[(newest_ + kHistory - whole_ticks_) % kHistory];
  const Vec3 older = sent_[(newest_ + kHistory - whole_ticks_ - 1U) % kHistory];
  return rest_ * older + (1.0F - rest_) * newer;
}

// The force is constant between ticks: its work is exactly force times displacement.
Vec3 PassivityController::update(Vec3 applied_force, const WallMotion& motion, float stored) {
  newest_ = (newest_ + 1U) % kHistory;
  sent_[newest_] = applied_force;
  const Vec3 displacement = following_ ? motion.probe - last_ - period_s_ * motion.wall : Vec3{};
  const float taken = -dot(acted(), displacement);
  const float balance = following_ ? observed_energy_ + taken - (stored - stored_) : 0.0F;
  absorbed_energy_ += taken;
  last_ = motion.probe;
  stored_ = stored;
  following_ = true;
  observed_energy_ = balance < 0.0F ? balance : 0.0F;
  // Damping that absorbs the excess energy within one tick at the current velocity.
  const Vec3 velocity = motion.velocity - motion.wall;
  const float squared = length_squared(velocity);
  if (!(observed_energy_ < 0.0F && squared > 0.0F)) {
    return {};
  }
  const float wanted = -observed_energy_ / (period_s_ * squared);
  return (wanted < damping_max_ ? -wanted : -damping_max_) * velocity;
}

float PassivityController::most_push(float speed_m_s, float slew_N_s) const {
  const float late_s = delay_s_ + period_s_;  // until a smaller force reaches the hand
  const float taken = absorbed_energy_ > 0.0F ? absorbed_energy_ : 0.0F;
  const float squared = late_s * late_s + 2.0F * taken / (slew_N_s * speed_m_s);
  return slew_N_s * (square_root(squared) - late_s);
}

}  // namespace tactree::core
