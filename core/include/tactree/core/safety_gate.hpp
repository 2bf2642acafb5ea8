#pragma once
// The last step before the motors. Whatever comes in, what goes out is finite, within the force
// limit and within the slew limit; after activation it starts at exactly 0 and ramps up.

#include <cstdint>

#include "tactree/core/faults.hpp"
#include "tactree/core/kinematics.hpp"
#include "tactree/core/motor_heat.hpp"
#include "tactree/core/vec3.hpp"

namespace tactree::core {

class SafetyGate;

/// Efforts for the motors, N or Nm per axis. Only a SafetyGate makes one.
class MotorCommand {
 public:
  [[nodiscard]] float effort(std::uint32_t axis) const { return effort_[axis]; }
  [[nodiscard]] bool is_zero() const {
    return effort_[0] == 0.0F && effort_[1] == 0.0F && effort_[2] == 0.0F;
  }

 private:
  friend class SafetyGate;
  MotorCommand() = default;
  float effort_[kAxes] = {0.0F, 0.0F, 0.0F};
};

struct GateLimits {
  float force_max_N = 8.0F;                                ///< 0.01 .. 1000
  float slew_N_per_tick = 2.0F;                            ///< force_max_N * 1e-4 .. 2 force_max_N
  float effort_max[kAxes] = {8.5F, 8.5F, 8.5F};            ///< N or Nm: 1e-4 .. 1000
  float effort_slew_per_tick[kAxes] = {2.0F, 2.0F, 2.0F};  ///< effort_max * 1e-4 .. 2 effort_max
  std::uint32_t ramp_ticks = 250;                          ///< from 0 to the whole force: 2 .. 1e6
  float continuous_share = 0.35F;     ///< of effort_max, what a motor bears for ever: 0.05 .. 1
  float heat_share_per_tick = 2e-5F;  ///< period over the windings' time constant: 1e-8 .. 0.1
};

/// Interrupt safe: no shared state.
class SafetyGate {
 public:
  [[nodiscard]] static MotorCommand no_command() { return {}; }

  struct Result {
    MotorCommand command{};
    Vec3 force{};  ///< N at the probe, before the limits of the axes
    LimitMask limits = 0;
    bool not_finite = false;  ///< an input was NaN or infinite; the command is zero

   private:
    friend class SafetyGate;
    Result() = default;
  };

  /// Takes the limits if all of them are in range; else changes nothing and returns false.
  /// The next command is zero.
  [[nodiscard]] bool configure(const GateLimits& limits);

  /// The command of a tick in which no force may be. Ramp and slew start anew; motors cool.
  Result release();

  /// The command of an active tick. `force` at the probe, N; `effort_per_force` maps it to axes;
  /// `own_effort`, N or Nm, holds the device's weight, ramps up as the force does, and has the
  /// limits of the axes only. Where these do not leave room for both, the force shrinks and keeps
  /// its direction; the efforts' change in a tick shrinks as a whole, too.
  /// Cost: constant, about 150 operations.
  Result command(Vec3 force, const Mat3& effort_per_force, Vec3 own_effort = {});

  [[nodiscard]] const GateLimits& limits() const { return limits_; }
  [[nodiscard]] const MotorHeat& heat() const { return heat_; }

 private:
  [[nodiscard]] Vec3 limit_force(Vec3 force, LimitMask& limits) const;
  [[nodiscard]] Vec3 limit_slew(Vec3 force, LimitMask& limits) const;
  void limit_axes(Vec3 own, Vec3 wanted, Result& result) const;
  void limit_axis_slew(const float (&target)[kAxes], Result& result) const;
  void warm_up();

  GateLimits limits_{};
  MotorHeat heat_{};
  Vec3 last_force_{};
  float last_effort_[kAxes] = {0.0F, 0.0F, 0.0F};
  std::uint32_t active_ticks_ = 0;
};

}  // namespace tactree::core
