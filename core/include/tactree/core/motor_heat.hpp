#pragma once
// How warm the windings are, from what was asked of the motors: heat follows the square of the
// effort with the time constant of the winding, 1 being what the continuous effort leads to for
// ever. From kWarm on the peak that is allowed falls, to the continuous effort at 1; so that a
// winding never gets warmer than its motor bears. (The I2t limit of servo drives; first order.)
//
// Interrupt safe: no shared state.

#include <cstdint>

#include "tactree/core/device_model.hpp"

namespace tactree::core {

class MotorHeat {
 public:
  static constexpr float kWarm = 0.8F;

  /// continuous_share: 0.05 .. 1 of an axis's effort_max; share_per_tick: period over time
  /// constant, > 0 and below 1. Keeps what is warm.
  void configure(float continuous_share, float share_per_tick);

  /// One tick in which an axis had this share of its effort_max: -1 .. 1.
  void add(std::uint32_t axis, float share);

  /// Share of effort_max that an axis may have now: continuous_share .. 1.
  [[nodiscard]] float allowed(std::uint32_t axis) const;

  [[nodiscard]] float heat(std::uint32_t axis) const { return heat_[axis]; }

 private:
  float continuous_ = 1.0F;
  float inverse_squared_ = 1.0F;  // of continuous_
  float share_ = 1e-5F;
  float heat_[kAxes] = {0.0F, 0.0F, 0.0F};
};

}  // namespace tactree::core
