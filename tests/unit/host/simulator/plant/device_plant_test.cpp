// The mechanics of devices with joints, and the controller on them.

#include "tactree/plant/device_plant.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "analytic_shapes.hpp"
#include "print_preset.hpp"
#include "tactree/simulation/simulation.hpp"

namespace tactree::test {
namespace {

using Eigen::Vector3d;
using plant::DevicePlant;
using plant::DevicePlantParameters;

DevicePlantParameters of(const core::DevicePreset& preset) {
  DevicePlantParameters p;
  p.model = preset.model;
  p.dynamics = preset.dynamics;
  p.has_weight = true;
  return p;
}

class EveryPlant : public testing::TestWithParam<core::DevicePreset> {};

// A swinging hand and an oscillating motor: the energy balance closes, and friction only
// dissipates.
TEST_P(EveryPlant, BalancesEnergy) {
  DevicePlant plant(of(GetParam()), Vector3d::Zero());
  const double begin = plant.kinetic_J() + plant.potential_J();
  const Vector3d most(0.1 * static_cast<double>(GetParam().drive.effort_max[0]),
                      0.1 * static_cast<double>(GetParam().drive.effort_max[1]),
                      0.1 * static_cast<double>(GetParam().drive.effort_max[2]));
  double lost = 0.0;
  double brought = 0.0;
  for (int i = 0; i < 1000; ++i) {
    const double t = i * 1e-3;
    const Vector3d wish(0.01 * std::sin(9.0 * t), 0.01 * std::cos(7.0 * t),
                        0.015 * std::sin(5.0 * t));
    plant.advance(std::sin(40.0 * t) * most, {wish, Vector3d::Zero()}, 1e-3);
    ASSERT_GE(plant.energy().friction, lost - 1e-12);
    lost = plant.energy().friction;
    brought = std::max(brought, std::abs(plant.energy().hand));
  }
  const double now = plant.kinetic_J() + plant.potential_J();
  EXPECT_GT(brought, 1e-3);
  EXPECT_NEAR(now - begin, plant.energy().motor + plant.energy().hand - plant.energy().friction,
              0.01 * brought);
}

// Without friction: gravity compensation from the counts alone holds the weight.
TEST_P(EveryPlant, GravityCompensationHoldsDevice) {
  for (const bool compensated : {true, false}) {
    DevicePlantParameters p = of(GetParam());
    for (float& coulomb : p.dynamics.coulomb) {
      coulomb = 0.0F;
    }
    p.hand = {0.0, 0.0, 0.0};
    DevicePlant plant(p, Vector3d::Zero());
    const Vector3d begin = plant.position_m();
    for (int i = 0; i < 300; ++i) {
      const Vector3d& q = plant.joints();
      const core::DevicePose pose = core::locate_joints(
          p.model,
          {static_cast<float>(q.x()), static_cast<float>(q.y()), static_cast<float>(q.z())});
      ASSERT_TRUE(pose.valid);
      const core::Vec3 hold = compensated ? pose.gravity_effort : core::Vec3{};
      plant.advance(widen(hold), {}, 1e-3);
    }
    const double sunk = (plant.position_m() - begin).norm();
    if (compensated) {
      EXPECT_LT(sunk, 2e-5);
    } else if (p.model.tip_mass_kg > 0.0F) {
      EXPECT_GT(sunk, 2e-3);
    }
  }
}

TEST_P(EveryPlant, StopsAtRangeEnds) {
  DevicePlant plant(of(GetParam()), Vector3d::Zero());
  const core::DeviceModel& m = GetParam().model;
  for (int i = 0; i < 500; ++i) {
    plant.advance(Vector3d::Zero(), {Vector3d(0.0, 0.0, 0.7), Vector3d::Zero()}, 1e-3);
  }
  for (Eigen::Index axis = 0; axis < plant.linkage().axes(); ++axis) {
    EXPECT_LE(plant.joints()[axis], static_cast<double>(m.joint_max[axis]) + 5e-3);
    EXPECT_GE(plant.joints()[axis], static_cast<double>(m.joint_min[axis]) - 5e-3);
  }
  EXPECT_LT(plant.velocity_m_s().norm(), 1e-2);
}

INSTANTIATE_TEST_SUITE_P(Presets, EveryPlant, testing::ValuesIn(core::kDevicePresets),
                         [](const auto& test) { return std::string(test.param.name); });

// Straight down onto a plane and up again, on each device that reaches it.
struct Press {
  double taken_J = 0.0;  // most that the wall took
  double left_J = 0.0;   // of it after release; negative: the wall gave more
  std::uint64_t contact_ticks = 0;
  core::FaultMask faults = 0;
};

Press press(const core::DevicePreset& device, float stiffness_N_m, float passivity_Ns_m) {
  static const Shape shape = plane();
  simulation::Setup setup;
  simulation::use_device(device, setup);
  setup.controller.contact.stiffness_N_m = stiffness_N_m;
  setup.controller.passivity_Ns_m = passivity_Ns_m;
  std::vector<simulation::Waypoint> way;
  for (int i = 0; i <= 1000; ++i) {
    const double t = i * 2e-3;
    way.push_back({t, {0.0, 0.0, 0.004 - 0.005 * (1.0 - std::cos(6.2831853 * t))}});
  }
  simulation::Simulation sim(shape.bytes(), setup, simulation::HandPath(way));
  EXPECT_TRUE(sim.start_result().ok());
  EXPECT_TRUE(sim.arm());
  Press result;
  Vector3d force = Vector3d::Zero();
  Vector3d last = Vector3d::Zero();
  for (int i = 0; i < 2000; ++i) {
    const simulation::Sample sample = sim.step();
    result.left_J -= i == 0 ? 0.0 : force.dot(sample.tip_m - last);
    result.taken_J = std::max(result.taken_J, result.left_J);
    force = widen(sample.status.force);
    last = sample.tip_m;
    result.contact_ticks += sample.status.rendering.in_contact ? 1U : 0U;
    result.faults |= sample.status.faults;
  }
  return result;
}

TEST(DeviceSimulation, EveryDeviceTouchesPlane) {
  for (const core::DevicePreset& device : core::kDevicePresets) {
    const Press p = press(device, 500.0F, 2.0F);
    EXPECT_GT(p.contact_ticks, 600U) << device.name;
    EXPECT_LT(p.contact_ticks, 1600U) << device.name;
    EXPECT_EQ(p.faults, 0U) << device.name;
  }
}

// Half the stability limit of the configuration's defaults, the design value, is 1500 N/m.
TEST(DeviceSimulation, PressingReleasesNoExtraEnergy) {
  for (const float stiffness : {200.0F, 500.0F, 1000.0F, 1500.0F}) {
    const Press p = press(core::presets::premium(), stiffness, 2.0F);
    EXPECT_GT(p.taken_J, 3e-4);
    EXPECT_GE(p.left_J, -0.01 * p.taken_J) << stiffness;
  }
  // The guard is needed: without it a stiff wall gives more.
  const Press active = press(core::presets::premium(), 3000.0F, 0.0F);
  EXPECT_LT(active.left_J, -0.01 * active.taken_J);
}

TEST(DeviceSimulation, KeepsContactWithSphere) {
  const Shape shape = sphere(0.03);
  simulation::Setup setup;
  simulation::use_device(core::presets::premium(), setup);
  const simulation::HandPath path({{0.0, {0.0, 0.0, 0.035}}, {0.3, {0.0, 0.0, 0.027}}});
  simulation::Simulation sim(shape.bytes(), setup, path);
  ASSERT_TRUE(sim.arm());
  int lost = 0;
  for (int i = 0; i < 3000; ++i) {
    const simulation::Sample sample = sim.step();
    ASSERT_EQ(sample.status.faults, 0U);
    lost += i > 500 && !sample.status.rendering.in_contact ? 1 : 0;
  }
  EXPECT_EQ(lost, 0);
}

}  // namespace
}  // namespace tactree::test
