#pragma once
// Output stage before the motors. For every input the output is finite and within the limits of
// force, slew and effort; after activation it starts at exactly 0 and ramps up. force_max_N limits
// the force at the probe of everything that the motors are told: rendered force, force of the
// application and gravity compensation together.

#include <cstdint>

#include "tactree/core/device/kinematics.hpp"
#include "tactree/core/math/vec3.hpp"
#include "tactree/core/safety/faults.hpp"
#include "tactree/core/safety/motor_heat.hpp"

namespace tactree::core {

class SafetyGate;

/// Efforts of the motors, N or Nm per axis. Only a SafetyGate constructs one.
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
  float force_max_N = 8.0F;                                ///< of all efforts: 0.01 .. 1000
  float slew_N_per_tick = 2.0F;                            ///< force_max_N * 1e-4 .. 2 force_max_N
  float effort_max[kAxes] = {8.5F, 8.5F, 8.5F};            ///< N or Nm: 1e-4 .. 1000
  float effort_slew_per_tick[kAxes] = {2.0F, 2.0F, 2.0F};  ///< effort_max * 1e-4 .. 2 effort_max
  std::uint32_t ramp_ticks = 250;                          ///< from 0 to full force: 2 .. 1e6
  float continuous_share = 0.35F;     ///< continuous effort / effort_max: 0.05 .. 1
  float heat_share_per_tick = 2e-5F;  ///< period / time constant of the windings: 1e-8 .. 0.1
  /// False: any motor may turn the wrong way. The forces at the probe of the single motors then add
  /// up to at most force_max_N, so no combination of signs exceeds it.
  bool signs_proven = true;
};

class ProbeForce;

/// Interrupt safe: no shared state.
class SafetyGate {
 public:
  struct Result {
    MotorCommand command{};
    Vec3 force{};          ///< N at the probe, without gravity, before the limits of the axes
    Vec3 gravity_force{};  ///< N at the probe, of the gravity compensation alone
    /// N at the probe, of `command`: everything that the motors are told, with proven signs.
    Vec3 motor_force{};
    LimitMask limits = 0;
    bool not_finite = false;  ///< an input was NaN or infinite; the command is zero

   private:
    friend class SafetyGate;
    Result() = default;
  };

  /// Applies the limits if all are in range; otherwise returns false and changes nothing.
  /// After success the ramp starts again at zero. Cost: constant.
  [[nodiscard]] bool configure(const GateLimits& limits);

  /// Returns zero effort for a tick that is not active. Restarts ramp and slew from zero; the
  /// thermal model cools.
  Result release();

  /// Command of an active tick. `force`: at the probe, N. `effort_per_force`: transposed Jacobian.
  /// `own_effort`: gravity compensation, N or Nm; it follows the ramp and has priority. If an axis
  /// limit or force_max_N is too small for both, the force is scaled down and keeps its direction.
  /// If an axis exceeds its slew limit, the changes of all efforts are scaled by a common factor.
  /// Only where the device has moved so far since the last tick that the efforts then exceed
  /// force_max_N do they fall faster, by a common factor. In a singular pose, where efforts have no
  /// bounded force at the probe, they are 0.
  /// Cost: constant, about 300 operations.
  Result command(Vec3 force, const Mat3& effort_per_force, Vec3 own_effort = {});

  /// Zero effort on all axes.
  [[nodiscard]] static MotorCommand no_effort() { return {}; }

  [[nodiscard]] const GateLimits& limits() const { return limits_; }
  [[nodiscard]] const MotorHeat& heat() const { return heat_; }

 private:
  [[nodiscard]] Vec3 limit_force(Vec3 force, LimitMask& limits) const;
  [[nodiscard]] Vec3 limit_slew(Vec3 force, LimitMask& limits) const;
  void limit_axes(Vec3 own, Vec3 wanted, const ProbeForce& at_probe, Result& result) const;
  void limit_axis_slew(const float (&target)[kAxes], Result& result) const;
  [[nodiscard]] Vec3 limit_gravity(Vec3 efforts, const ProbeForce& at_probe, Result& result,
                                   float& size_N) const;
  [[nodiscard]] float share_of_force(float without, float with, LimitMask& limits) const;
  void limit_motor_force(const ProbeForce& at_probe, Result& result) const;
  void update_thermal_model();

  GateLimits limits_{};
  MotorHeat heat_{};
  Vec3 last_force_{};
  float last_effort_[kAxes] = {0.0F, 0.0F, 0.0F};
  std::uint32_t active_ticks_ = 0;
};

}  // namespace tactree::core
