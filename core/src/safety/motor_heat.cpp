// Loop and memory annotations: docs/BOUND.md.
// memory: RAM

#include "tactree/core/safety/motor_heat.hpp"

namespace tactree::core {

void MotorHeat::configure(float continuous_share, float share_per_tick) {
  continuous_ = continuous_share;
  inverse_squared_ = 1.0F / (continuous_share * continuous_share);
  share_ = share_per_tick;
}

void MotorHeat::add(std::uint32_t axis, float share) {
  heat_[axis] += share_ * (share * share * inverse_squared_ - heat_[axis]);
}

float MotorHeat::allowed(std::uint32_t axis) const {
  const float heat = heat_[axis];
  if (!(heat > kWarm)) {
    return 1.0F;
  }
  const float room = heat < 1.0F ? (1.0F - heat) * (1.0F / (1.0F - kWarm)) : 0.0F;
  return continuous_ + (1.0F - continuous_) * room;
}

}  // namespace tactree::core
