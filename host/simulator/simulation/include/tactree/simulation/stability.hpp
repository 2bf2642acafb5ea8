#pragma once
// Maximum stable stiffness of a wall, measured in a closed loop of the controller's velocity
// estimator and passivity controller with a mass. The motion of the mass between two ticks is the
// exact solution. core::stability_limit() predicts the same limit.

#include "tactree/core/configuration/configuration.hpp"

namespace tactree::simulation {

/// A tip at a wall with dampers only: the worst case.
struct StabilityCase {
  double mass_kg = 0.075;  ///< of device and hand
  double device_damping_Ns_m = 0.05;
  double hand_damping_Ns_m = 0.0;     ///< 0: no hand
  double wall_damping_Ns_m = 0.0;     ///< on the estimated velocity
  double velocity_cutoff_hz = 200.0;  ///< at most half the rate
  double rate_hz = 1000.0;
  double delay_s = 0.0;  ///< from the encoders to the force, beyond the sampling: 0 .. 60 ticks
  double encoder_step_m = 0.0;
  double passivity_Ns_m = 0.0;  ///< maximum damping of the passivity controller; 0: off
};

/// True if a tip that is released 1 mm from the equilibrium comes to rest: in the last quarter of
/// 10 s it must stay within 1 mm.
[[nodiscard]] bool is_stable(const StabilityCase& c, double stiffness_N_m);

/// Maximum stable stiffness between 1 and 1e6 N/m, accurate to 0.2 %. Cost: the ticks of about 20
/// runs of 10 s, which take 20 ms at 1 kHz.
[[nodiscard]] double largest_stable_stiffness(const StabilityCase& c);

/// Result of core::stability_limit() for the case.
[[nodiscard]] double predicted_stiffness(const StabilityCase& c);

}  // namespace tactree::simulation
