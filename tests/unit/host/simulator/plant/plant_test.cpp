// The mechanics against closed-form solutions.

#include "tactree/plant/plant.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

#include "message_of.hpp"

namespace tactree::test {
namespace {

using Eigen::Vector3d;
using plant::HandTarget;
using plant::Plant;
using plant::PlantParameters;

PlantParameters bare_mass() {
  PlantParameters p;
  p.device = {0.2, 0.0, 0.0};
  p.hand = {0.0, 0.0, 0.0};
  return p;
}

TEST(Plant, FollowsNewtonsLaw) {
  Plant plant(bare_mass(), Vector3d(0.1, 0.0, 0.0));
  for (int i = 0; i < 1000; ++i) {
    plant.advance({0.0, 0.0, 1.0}, {}, 1e-3);
  }
  EXPECT_NEAR(plant.velocity_m_s().z(), 5.0, 1e-9);
  EXPECT_NEAR(plant.position_m().z(), 2.5, 2.5e-4);
  EXPECT_EQ(plant.position_m().x(), 0.1);
}

TEST(Plant, ViscousFrictionDecaysExponentially) {
  PlantParameters p = bare_mass();
  p.device.viscous_Ns_m = 2.0;
  Plant plant(p, Vector3d::Zero());
  plant.advance({100.0, 0.0, 0.0}, {}, 0.01);
  const double begin = plant.velocity_m_s().x();
  plant.advance(Vector3d::Zero(), {}, 0.1);
  EXPECT_NEAR(plant.velocity_m_s().x() / begin, std::exp(-1.0), 1e-3);
}

TEST(Plant, DryFrictionHoldsAndStops) {
  PlantParameters p = bare_mass();
  p.device.coulomb_N = 0.04;
  Plant held(p, Vector3d::Zero());
  held.advance({0.0399, -0.0399, 0.0}, {}, 1.0);
  EXPECT_EQ(held.position_m(), Vector3d::Zero());
  held.advance({0.05, 0.0, 0.0}, {}, 1.0);
  EXPECT_NEAR(held.velocity_m_s().x(), 0.01 / 0.2, 1e-9);
  held.advance(Vector3d::Zero(), {}, 0.24);  // 0.05 m/s last 0.25 s
  EXPECT_GT(held.velocity_m_s().x(), 0.0);
  held.advance(Vector3d::Zero(), {}, 0.02);
  EXPECT_EQ(held.velocity_m_s(), Vector3d::Zero());
}

TEST(Plant, HandOscillatesAtItsFrequency) {
  PlantParameters p;
  p.device = {0.1, 0.0, 0.0};
  p.hand = {0.1, 200.0, 0.0};
  Plant plant(p, Vector3d(0.01, 0.0, 0.0));
  const double period = 2.0 * 3.14159265358979 * std::sqrt(0.2 / 200.0);
  plant.advance(Vector3d::Zero(), {}, 0.5 * period);
  EXPECT_NEAR(plant.position_m().x(), -0.01, 2e-5);
  plant.advance(Vector3d::Zero(), {}, 0.5 * period);
  EXPECT_NEAR(plant.position_m().x(), 0.01, 2e-5);
}

TEST(Plant, FollowsMovingTarget) {
  Plant plant({}, Vector3d::Zero());
  const Vector3d speed(0.1, 0.0, 0.0);
  for (int i = 0; i < 2000; ++i) {
    plant.advance(Vector3d::Zero(), {speed * (i * 1e-3), speed}, 1e-3);
  }
  EXPECT_NEAR(plant.velocity_m_s().x(), 0.1, 1e-4);
  // Lag by friction and damping of the device: (0.04 + 0.05 * 0.1) / 300.
  EXPECT_NEAR(plant.position_m().x(), 0.2 - 0.045 / 300.0, 2e-5);
}

TEST(Plant, BalancesEnergy) {
  PlantParameters p;
  Plant plant(p, Vector3d::Zero());
  double throughput = 0.0;
  for (int i = 0; i < 3000; ++i) {
    const double t = i * 1e-3;
    const Vector3d force(std::sin(40.0 * t), 2.0 * std::cos(23.0 * t), -1.0);
    const HandTarget target{{0.02 * std::sin(9.0 * t), 0.0, 0.01},
                            {0.18 * std::cos(9.0 * t), 0.0, 0.0}};
    const double before = plant.energy().friction;
    plant.advance(force, target, 1e-3);
    ASSERT_GE(plant.energy().friction, before);  // friction only takes
    throughput = std::max(throughput, std::abs(plant.energy().motor));
  }
  const plant::Energy& e = plant.energy();
  EXPECT_GT(throughput, 1e-3);
  EXPECT_NEAR(plant.kinetic_J(), e.motor + e.hand - e.friction, 1e-9);
}

TEST(Plant, IsDeterministicAndConverges) {
  const auto run = [](double substep_s) {
    PlantParameters p;
    p.substep_s = substep_s;
    Plant plant(p, Vector3d::Zero());
    for (int i = 0; i < 500; ++i) {
      plant.advance({0.0, 0.0, 0.5}, {{0.01, 0.0, 0.0}, Vector3d::Zero()}, 1e-3);
    }
    return plant.position_m();
  };
  EXPECT_EQ(run(5e-5), run(5e-5));
  EXPECT_LT((run(5e-5) - run(1e-6)).norm(), 2e-5);
  EXPECT_GT((run(5e-5) - run(1e-6)).norm(), 0.0);
}

TEST(Plant, RefusesImpossibleParametersByName) {
  const auto message = [](auto&& change) {
    PlantParameters p;
    change(p);
    return message_of<std::invalid_argument>([&] { const Plant plant(p, Vector3d::Zero()); });
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(message([](PlantParameters&) {}), "");
  EXPECT_EQ(message([](PlantParameters& p) { p.device.mass_kg = 0.0; }),
            "device.mass_kg is out of range");
  EXPECT_EQ(message([=](PlantParameters& p) { p.device.coulomb_N = nan; }),
            "device.coulomb_N is out of range");
  EXPECT_EQ(message([](PlantParameters& p) { p.hand.stiffness_N_m = -1.0; }),
            "hand.stiffness_N_m is out of range");
  EXPECT_EQ(message([](PlantParameters& p) { p.substep_s = 1.0; }), "substep_s is out of range");
}

}  // namespace
}  // namespace tactree::test
