#pragma once
// Thermal model of the windings from the commanded efforts: heat follows the square of the effort
// with the time constant of the winding. Heat 1 is the steady state of the continuous effort. Above
// kWarm the allowed peak falls linearly to the continuous effort at heat 1, which keeps the winding
// within its rating. (First-order I2t limit, as in servo drives.)
//
// Interrupt safe: no shared state.

#include <cstdint>

#include "tactree/core/device/device_model.hpp"

namespace tactree::core {

class MotorHeat {
 public:
  static constexpr float kWarm = 0.8F;

  /// continuous_share: 0.05 .. 1 of an axis's effort_max; share_per_tick: period over time
  /// constant, > 0 and below 1. Keeps the heat.
  void configure(float continuous_share, float share_per_tick);

  /// Adds one tick. share: effort / effort_max of the axis, -1 .. 1. Cost: constant.
  void add(std::uint32_t axis, float share);

  /// Allowed effort / effort_max of an axis: continuous_share .. 1. Cost: constant.
  [[nodiscard]] float allowed(std::uint32_t axis) const;

  [[nodiscard]] float heat(std::uint32_t axis) const { return heat_[axis]; }

 private:
  float continuous_ = 1.0F;
  float inverse_squared_ = 1.0F;  // of continuous_
  float share_ = 1e-5F;
  float heat_[kAxes] = {0.0F, 0.0F, 0.0F};
};

}  // namespace tactree::core
