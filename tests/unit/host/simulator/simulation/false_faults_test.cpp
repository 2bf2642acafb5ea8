// A sound device in any hands gives no fault.

#include <gtest/gtest.h>

#include <random>
#include <string>

#include "analytic_shapes.hpp"
#include "print_preset.hpp"
#include "tactree/simulation/simulation.hpp"
#include "tactree/simulation/workspace.hpp"

namespace tactree::test {
namespace {

using simulation::HandPath;
using simulation::Simulation;
using simulation::Waypoint;

const Shape& ball() {
  static const Shape shape = evaluation::sphere();
  return shape;
}

simulation::Setup setup_of(const core::DevicePreset& device, float rate_hz) {
  simulation::Setup setup;
  setup.controller.rate_hz = rate_hz;
  simulation::use_device(device, setup);
  core::limit_to_rate(setup.controller);
  return setup;
}

/// Faults of a session, by name.
std::string faults_along(const simulation::Setup& setup, HandPath path, double seconds,
                         const Shape& shape = ball()) {
  Simulation sim(shape.bytes(), setup, std::move(path));
  EXPECT_TRUE(sim.start_result().ok());
  EXPECT_TRUE(sim.arm());
  simulation::Recorder recorder;
  const auto ticks = static_cast<int>(seconds * static_cast<double>(setup.controller.rate_hz));
  for (int i = 0; i < ticks; ++i) {
    recorder.add(sim.step());
  }
  std::string names;
  for (const simulation::FaultEvent& event : recorder.summary().faults) {
    names +=
        std::string(core::name_of(event.fault)) + " at tick " + std::to_string(event.tick) + "; ";
  }
  return names;
}

class SoundDevice : public testing::TestWithParam<core::DevicePreset> {};

TEST_P(SoundDevice, StaysFaultlessAtRangeEnds) {
  const Eigen::Vector3d ends[] = {{0.0, 0.0, -0.12}, {0.0, 0.0, 0.3},  {0.3, 0.0, 0.05},
                                  {-0.3, 0.0, 0.05}, {0.0, 0.3, 0.05}, {0.0, -0.3, 0.05}};
  for (const Eigen::Vector3d& end : ends) {
    const Eigen::Vector3d start(0.0, 0.0, 0.05);
    const HandPath path({{0.0, start}, {0.8, end}, {1.4, end}, {2.0, start}});
    EXPECT_EQ(faults_along(setup_of(GetParam(), 1000.0F), path, 2.5), "")
        << "hand at " << end.transpose();
  }
}

TEST_P(SoundDevice, StaysFaultlessInRandomHands) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> place(-0.12, 0.12);
  std::uniform_real_distribution<double> pause(0.05, 0.6);
  for (int session = 0; session < 2; ++session) {
    std::vector<Waypoint> waypoints{{0.0, {0.0, 0.0, 0.06}}};
    while (waypoints.back().t_s < 6.0) {
      waypoints.push_back(
          {waypoints.back().t_s + pause(random), {place(random), place(random), place(random)}});
    }
    const simulation::Setup setup = setup_of(GetParam(), session % 2 ? 4000.0F : 1000.0F);
    EXPECT_EQ(faults_along(setup, HandPath(waypoints), 6.0), "") << "session " << session;
  }
}

// The force grows along a line on which some joint stands still: its motor carries a part of the
// force, but the hand yields by the other joints.
TEST_P(SoundDevice, StaysFaultlessPushedStraightDown) {
  for (const double x : {-0.03, -0.01, 0.01, 0.03}) {
    for (const double y : {-0.02, -0.005, 0.005, 0.02}) {
      const HandPath path({{0.0, {x, y, 0.06}}, {1.0, {x, y, -0.06}}, {1.6, {x, y, -0.06}}});
      EXPECT_EQ(faults_along(setup_of(GetParam(), 1000.0F), path, 1.6), "") << x << ", " << y;
    }
  }
}

// Axes that rest for longer than stuck_s take some ticks to follow a force that turns to them: a
// stiff hand pushes the probe through the object, beyond the maximum force.
TEST_P(SoundDevice, StaysFaultlessPushedThroughObject) {
  simulation::Setup setup = setup_of(GetParam(), 4000.0F);
  setup.controller.contact.stiffness_N_m =
      0.7F * core::stability_limit(setup.controller).with_hand_N_m;
  setup.plant.hand.stiffness_N_m = 1000.0;
  // The pantograph reaches only the outside of a smaller ball.
  const bool reaches_large = simulation::reaches(setup.controller.device, {0.0, 0.0, 0.048});
  const double scale = reaches_large ? 1.0 : 0.6;
  const Shape large_ball = evaluation::sphere(0.04 * scale, 0.002 * scale);
  for (const double x : {-0.005, -0.011251, -0.02}) {
    const Eigen::Vector3d above = scale * Eigen::Vector3d(x, 0.0017, 0.0479);
    const Eigen::Vector3d below = scale * Eigen::Vector3d(x, 0.0017, -0.0524);
    const HandPath path(
        {{0.0, {0.0, 0.0, scale * 0.06}}, {0.3, above}, {0.9, above}, {1.16, below}, {1.5, below}});
    EXPECT_EQ(faults_along(setup, path, 1.5, large_ball), "") << x;
  }
}

INSTANTIATE_TEST_SUITE_P(FalseFaults, SoundDevice, testing::ValuesIn(core::kDevicePresets));

}  // namespace
}  // namespace tactree::test
