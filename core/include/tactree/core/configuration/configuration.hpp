#pragma once
// Parameters of the control loop: unit, range and default of each, the check of their ranges, and
// the stability limit.
//
// Interrupt safe: pure functions.

#include <cstdint>

#include "tactree/core/device/kinematics.hpp"
#include "tactree/core/math/vec3.hpp"
#include "tactree/core/safety/safety_gate.hpp"

namespace tactree::core {

enum class RenderMode : std::uint8_t {
  kSurface = 0,  ///< fitted surface, proxy, friction
  kPaper = 1,    ///< the paper's collision boxes and nearest point
};

/// Parameters of a contact.
struct ContactParameters {
  float stiffness_N_m = 500.0F;   ///< 0 .. 1e5, below the stability limit with a hand
  float damping_Ns_m = 0.5F;      ///< 0 .. 1000
  float static_friction = 0.4F;   ///< 0 .. 2
  float dynamic_friction = 0.3F;  ///< 0 .. static_friction
  /// Depth of texture_depth() (material.hpp): 0 .. 0.01, at most half of the wavelength; 0: smooth.
  float texture_height_m = 0.0F;
  float texture_wavelength_m = 2e-3F;  ///< 1e-4 .. 1
};

/// Limits of the force at the probe.
struct ForceLimits {
  float force_max_N = 8.0F;  ///< of everything that the motors are told: 0.01 .. 1000
  float slew_N_s = 2000.0F;  ///< per tick: force_max_N * (1e-4 .. 2)
  float ramp_s = 0.25F;      ///< from 0 to full force: 2 ticks .. 10 s
  bool operator==(const ForceLimits&) const = default;
};

/// Limits of the motors.
struct MotorLimits {
  float effort_max[kAxes] = {8.5F, 8.5F, 8.5F};              ///< N or Nm: 1e-4 .. 1000
  float effort_slew_s[kAxes] = {2000.0F, 2000.0F, 2000.0F};  ///< N/s or Nm/s, as slew_N_s
  float continuous_share = 0.35F;  ///< continuous effort / effort_max: 0.05 .. 1
  float thermal_time_s = 50.0F;    ///< time constant of the windings: 1 .. 1000
  bool signs_proven = true;        ///< false: force_max_N holds even if motors turn the wrong way
};

/// Supervision of the link to an application.
struct LinkSupervision {
  bool required = false;    ///< true: a lost link is a fault
  float timeout_s = 0.02F;  ///< 0.005 .. 0.1; cannot be disabled
  /// False: an application may watch and stop, and nothing else; the device is operated by a panel
  /// (hal/panel.hpp). Requires `required` to be false.
  bool may_command = true;
  bool operator==(const LinkSupervision&) const = default;
};

/// Supervision of encoders, amplifiers and the hand on the device.
struct Supervision {
  float speed_max_m_s = 10.0F;     ///< of the probe; above: encoder fault: 0.1 .. 100
  float stuck_s = 0.5F;            ///< time without counts under a changing force: 0.01 .. 1
  float enable_timeout_s = 0.05F;  ///< delay of the enable read-back: 0.001 .. 1
  bool dead_man_required = true;   ///< false: a second arm command replaces it
  bool supply_monitored = false;   ///< the board measures the amplifiers' supply
  float supply_min_V = 18.0F;      ///< where monitored: 1 .. supply_max_V
  float supply_max_V = 30.0F;      ///< where monitored: supply_min_V .. 1000
};

/// The defaults are safe for a PHANTOM Premium class device at 1 kHz.
struct Configuration {
  float rate_hz = 1000.0F;  ///< ticks per second: 100 .. 20 000
  RenderMode mode = RenderMode::kSurface;
  DeviceModel device{};   ///< device_model.hpp
  Vec3 model_origin_m{};  ///< origin of the model in the device's frame: within +-10 m

  ContactParameters contact{};  ///< where the model has no materials
  /// Use the materials of the blob, if present; each must be below the stability limit.
  bool use_materials = true;

  /// The motors compensate the weight of the device. Requires motors.signs_proven: with the wrong
  /// sign a motor would double the weight instead of carrying it.
  bool compensate_gravity = true;
  float velocity_cutoff_hz = 200.0F;  ///< low-pass filter of the velocity: 1 .. rate_hz / 2
  /// Maximum damping that the passivity controller adds: 0 .. 100; 0: off.
  float passivity_Ns_m = 2.0F;

  // The device and the hand, for the stability limit.
  float device_damping_Ns_m = 0.05F;  ///< 0 .. 1000
  float hand_damping_Ns_m = 1.0F;     ///< 0 .. 1000: a light hand
  /// From encoder to force, beyond the sampling: 0 .. 0.1, and at most kMaxDelayTicks ticks.
  float delay_s = 0.0F;

  ForceLimits limits{};
  MotorLimits motors{};
  Supervision supervision{};
  LinkSupervision link{};
};

enum class ConfigurationStatus : std::uint8_t {
  kOk = 0,
  kBusy,  ///< armed or active: stop first
  kBadRate,
  kBadMode,
  kBadDevice,
  kBadOrigin,
  kBadStiffness,
  kBadDamping,
  kBadFriction,
  kBadTexture,
  kBadFilter,
  kBadLimit,  ///< of ForceLimits or MotorLimits
  kBadRamp,
  kBadSpeed,
  kBadTimeout,
  kBadSupply,
  kUnstable,       ///< stiffness above the stability limit with a hand
  kBadLink,        ///< a link that is required must be able to command
  kUnprovenSigns,  ///< gravity compensation by motors whose signs are not proven
};

/// Maximum of delay_s in ticks: the passivity controller observes no longer delay (passivity.hpp).
/// With it, the stability limit is already 1/31 of that without delay: 100 N/m by default at 1 kHz.
inline constexpr std::uint32_t kMaxDelayTicks = 15;

/// Lowers what the rate limits, after rate_hz was changed: velocity_cutoff_hz to rate_hz / 2.
constexpr void limit_to_rate(Configuration& configuration) {
  const float limit_hz = 0.5F * configuration.rate_hz;
  if (configuration.velocity_cutoff_hz > limit_hz) {
    configuration.velocity_cutoff_hz = limit_hz;
  }
}

/// Sets force_max_N, and lowers slew_N_s to a millionth below the largest value that a tick may
/// then have, because the slew rate of a tick may be rounded up.
constexpr void limit_force(Configuration& configuration, float force_max_N) {
  const float slew_N_s = 2.0F * 0.999999F * force_max_N * configuration.rate_hz;
  configuration.limits.force_max_N = force_max_N;
  if (configuration.limits.slew_N_s > slew_N_s) {
    configuration.limits.slew_N_s = slew_N_s;
  }
}

/// Description of the status: "rate_hz is outside 100 .. 20000", ...
[[nodiscard]] const char* describe(ConfigurationStatus status);

/// The first value that is not finite, out of its range, or not consistent with the others.
struct Refusal {
  ConfigurationStatus status = ConfigurationStatus::kOk;
  const char* field = "";  ///< as in Configuration: "limits.slew_N_s"; may be empty
  float value = 0.0F;
  float min = 0.0F;  ///< with the other values as they are
  float max = 0.0F;
  std::int32_t axis = -1;  ///< of a field with one value per axis; else -1
};

/// Checks all values. Cost: constant.
[[nodiscard]] Refusal refusal_of(const Configuration& configuration);
[[nodiscard]] inline ConfigurationStatus check(const Configuration& configuration) {
  return refusal_of(configuration).status;
}

/// Maximum of first_force(), N: a force that the hand notices and overcomes without effort.
inline constexpr float kFirstForce_N = 0.5F;

/// The configuration for the first force of a new device, amplifier or wiring: at most
/// kFirstForce_N, with the slew rates and efforts reduced in proportion, without gravity
/// compensation, and with no trust in the signs of the motors (MotorLimits::signs_proven). A
/// configuration whose maximum is below kFirstForce_N keeps it. Precondition: check() accepts the
/// configuration; it then accepts the result.
[[nodiscard]] Configuration first_force(const Configuration& configuration);

/// Stiffest stable wall, N/m: (b + B + b_hand) / (T / 2 + t_d), after Colgate and Brown, "Factors
/// affecting the Z-width of a haptic display", ICRA 1994, with the delay and the hand. Within 1 %
/// of the simulated limit for B = 0 and within 3 % for an unfiltered B; a filter of 200 Hz reduces
/// it by 5 % at 1 kHz and by 13 % at 10 kHz. The damping of the passivity controller is margin and
/// not included. Recommended design value: half of the limit. Cost: constant.
struct StabilityLimit {
  float without_hand_N_m = 0.0F;
  float with_hand_N_m = 0.0F;
};
[[nodiscard]] StabilityLimit stability_limit(const Configuration& configuration);

/// Limits of the safety gate, per tick. Precondition: rate_hz > 0. Cost: constant.
[[nodiscard]] GateLimits gate_limits(const Configuration& configuration);

}  // namespace tactree::core
