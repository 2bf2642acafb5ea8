#pragma once
// How stiff a wall may be before the hand feels it shake: measured in a closed loop of the
// controller's own parts - velocity estimator, passivity controller - and a mass that moves exactly
// as mechanics says between two ticks. Compare core::stability_limit().

#include "tactree/core/configuration.hpp"

namespace tactree::simulation {

/// A tip held at a wall by nothing but dampers: the hardest case.
struct StabilityCase {
  double mass_kg = 0.075;  ///< of device and hand
  double device_damping_Ns_m = 0.05;
  double hand_damping_Ns_m = 0.0;     ///< 0: nobody holds it
  double wall_damping_Ns_m = 0.0;     ///< by the estimated velocity
  double velocity_cutoff_hz = 200.0;  ///< at most half the rate
  double rate_hz = 1000.0;
  double delay_s = 0.0;  ///< from the encoders to the force, beyond the sampling: 0 .. 60 ticks
  double encoder_step_m = 0.0;
  double passivity_Ns_m = 0.0;  ///< most that the passivity controller may add; 0: off
};

/// Does a tip that is let go 1 mm from the wall's balance come to rest? 10 s are simulated; in the
/// last quarter it must be nearer than it began.
[[nodiscard]] bool is_stable(const StabilityCase& c, double stiffness_N_m);

/// Largest stable stiffness, N/m, within 0.2 %, between 1 and 1e6. Cost: about 20 times 10 s of
/// ticks; 20 ms at 1 kHz.
[[nodiscard]] double largest_stable_stiffness(const StabilityCase& c);

/// What core::stability_limit() says of the case.
[[nodiscard]] double predicted_stiffness(const StabilityCase& c);

}  // namespace tactree::simulation
