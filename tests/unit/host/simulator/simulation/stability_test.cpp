// Largest stable stiffness in a closed loop against the formula, and the effect of passivity
// control.

#include "tactree/simulation/stability.hpp"

#include <gtest/gtest.h>

namespace tactree::test {
namespace {

using simulation::StabilityCase;

double measured_share(const StabilityCase& c) {
  return simulation::largest_stable_stiffness(c) / simulation::predicted_stiffness(c);
}

StabilityCase held() {
  StabilityCase c;
  c.mass_kg = 0.175;
  c.device_damping_Ns_m = 0.1;
  c.hand_damping_Ns_m = 1.0;
  return c;
}

TEST(Stability, MeasuredLimitMatchesFormula) {
  for (const double rate : {1000.0, 4000.0}) {
    for (const double delay : {0.0, 0.3e-3}) {
      StabilityCase with_hand = held();
      with_hand.rate_hz = rate;
      with_hand.delay_s = delay;
      EXPECT_NEAR(measured_share(with_hand), 1.0, 0.01) << rate << " " << delay;
      StabilityCase alone = with_hand;
      alone.mass_kg = 0.1;
      alone.device_damping_Ns_m = 0.5;
      alone.hand_damping_Ns_m = 0.0;
      EXPECT_NEAR(measured_share(alone), 1.0, 0.01) << rate << " " << delay;
    }
  }
}

TEST(Stability, VirtualDampingMatchesFormula) {
  StabilityCase c = held();
  c.device_damping_Ns_m = 0.2;
  c.hand_damping_Ns_m = 0.0;
  c.wall_damping_Ns_m = 2.0;
  EXPECT_NEAR(measured_share(c), 1.0, 0.1);
  c.rate_hz = 4000.0;
  EXPECT_NEAR(measured_share(c), 1.0, 0.1);
}

TEST(Stability, PassivityControlAllowsStifferWall) {
  for (const double step_m : {0.0, 30e-6}) {
    for (const double delay : {0.0, 0.3e-3}) {
      StabilityCase c = held();
      c.encoder_step_m = step_m;
      c.delay_s = delay;
      const double without = simulation::largest_stable_stiffness(c);
      c.passivity_Ns_m = 2.0;  // the configuration's default
      EXPECT_GE(simulation::largest_stable_stiffness(c), 1.7 * without) << step_m << " " << delay;
    }
  }
}

}  // namespace
}  // namespace tactree::test
