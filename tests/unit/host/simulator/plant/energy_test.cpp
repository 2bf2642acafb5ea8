// Promise F7: over the accepted range of stiffness a wall releases no more energy than it absorbed,
// within 1 %; a stiffness beyond the range is refused.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "controller_rig.hpp"
#include "tactree/plant/plant.hpp"

namespace tactree::test {
namespace {

struct Account {
  double put_in_J = 0.0;
  double given_back_J = 0.0;
  double deepest_m = 0.0;
  core::FaultMask faults = 0;
};

/// A light hand presses ten times into the plane and comes out again; the controller's whole tick,
/// counts included, acts on a device with mass and friction.
Account press(const core::Configuration& configuration, double depth_m, double period_s) {
  ControllerRig session(configuration);
  session.step();
  session.activate();
  plant::PlantParameters parameters;
  parameters.hand.damping_Ns_m = 1.0;
  plant::Plant tip(parameters, {0.0, 0.0, 0.01});
  const double tick_s = 1.0 / static_cast<double>(configuration.rate_hz);
  Account account;
  double hand_before = 0.0;
  for (float t = 0.0F; t < configuration.limits.ramp_s + 0.1F; t += 1.0F / configuration.rate_hz) {
    session.move(0.0, 0.0, 0.01);
    session.step();  // a wall that grows under the hand is put in by the controller
  }
  const double turn = 2.0 * std::numbers::pi / period_s;
  for (double t = 0.0; t < 10.0 * period_s; t += tick_s) {
    session.move(tip.position_m().x(), tip.position_m().y(), tip.position_m().z());
    const core::Output output = session.step();
    account.faults |= output.status.faults;
    const Eigen::Vector3d motor(static_cast<double>(output.motors.effort(0)),
                                static_cast<double>(output.motors.effort(1)),
                                static_cast<double>(output.motors.effort(2)));
    const double swing = 0.005 + 0.5 * depth_m;
    plant::HandTarget target;
    target.position_m = {0.0, 0.0, 0.01 - swing * (1.0 - std::cos(turn * t))};
    target.velocity_m_s = {0.0, 0.0, -swing * turn * std::sin(turn * t)};
    tip.advance(motor, target, tick_s);
    const double work = tip.energy().hand - hand_before;
    hand_before = tip.energy().hand;
    (work > 0.0 ? account.put_in_J : account.given_back_J) += std::abs(work);
    account.deepest_m = std::max(account.deepest_m, -tip.position_m().z());
  }
  return account;
}

double hardest(const core::Configuration& configuration) {
  return static_cast<double>(core::stability_limit(configuration).with_hand_N_m);
}

TEST(Energy, KeepsAcceptedWallsPassive) {
  for (const float rate_hz : {1000.0F, 4000.0F}) {
    core::Configuration configuration;
    configuration.rate_hz = rate_hz;
    const double limit = hardest(configuration);
    for (const double share : {0.02, 0.1, 0.25, 0.5, 0.75, 0.999}) {
      configuration.contact.stiffness_N_m = static_cast<float>(share * limit);
      ASSERT_EQ(check(configuration), core::ConfigurationStatus::kOk) << share;
      for (const double period_s : {1.0, 0.4, 0.2, 0.1}) {
        const Account account = press(configuration, 0.02, period_s);
        EXPECT_LE(account.given_back_J, 1.01 * account.put_in_J)
            << rate_hz << " Hz, " << share << " of " << limit << " N/m, each " << period_s << " s";
        EXPECT_GT(account.put_in_J, 1e-3);
        EXPECT_GT(account.deepest_m, 1e-4) << "the wall was not touched";
        EXPECT_EQ(account.faults, 0U);
      }
    }
    configuration.contact.stiffness_N_m = static_cast<float>(1.001 * limit);
    EXPECT_EQ(check(configuration), core::ConfigurationStatus::kUnstable);
  }
}

}  // namespace
}  // namespace tactree::test
