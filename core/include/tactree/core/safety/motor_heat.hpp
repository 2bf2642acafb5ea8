#pragma once
// Thermal model of the motor windings. The heat follows the square of the commanded effort with the
// time constant of the winding; heat 1 is the steady state at the continuous effort. Above kWarm
// the allowed peak effort falls linearly, to the continuous effort at heat 1, which keeps the
// winding within its rating (first-order I2t limit, as in servo drives).
//
// Interrupt safe: no shared state.

#include <cstdint>

#include "tactree/core/device/device_model.hpp"

namespace tactree::core {

class MotorHeat {
 public:
  /// Heat above which the allowed peak falls. With the default continuous share of 0.35 and 50 s, a
  /// cold motor has its full effort for 5.2 s. With 1 it would be 6.5 s, but the effort would then
  /// drop to the continuous one at once. Less would reduce the peaks of a motor that runs within
  /// its rating: heat 0.8 is the steady state at 0.89 of the continuous effort.
  static constexpr float kWarm = 0.8F;

  /// continuous_share: continuous effort / effort_max, 0.05 .. 1. share_per_tick: period / time
  /// constant, between 0 and 1. Keeps the present heat.
  void configure(float continuous_share, float share_per_tick);

  /// Updates the heat by one tick. share: effort / effort_max of the axis, -1 .. 1. Cost: constant.
  void add(std::uint32_t axis, float share);

  /// Allowed effort / effort_max of an axis: continuous_share .. 1. Cost: constant.
  [[nodiscard]] float allowed(std::uint32_t axis) const;

  [[nodiscard]] float heat(std::uint32_t axis) const { return heat_[axis]; }

 private:
  float continuous_ = 1.0F;
  float inverse_squared_ = 1.0F;  // 1 / continuous_^2
  float share_ = 1e-5F;
  float heat_[kAxes] = {0.0F, 0.0F, 0.0F};
};

}  // namespace tactree::core
