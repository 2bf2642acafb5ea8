// A sound device in any hands gives no fault.

#include <gtest/gtest.h>

#include <random>
#include <string>

#include "analytic_shapes.hpp"
#include "print_preset.hpp"
#include "tactree/simulation/simulation.hpp"

namespace tactree::test {
namespace {

using simulation::HandPath;
using simulation::Simulation;
using simulation::Waypoint;

const Shape& ball() {
  static const Shape shape = evaluation::sphere();
  return shape;
}

/// Faults of a session, by name.
std::string faults_along(const core::DevicePreset& device, HandPath path, double seconds,
                         float rate_hz) {
  simulation::Setup setup;
  setup.controller.rate_hz = rate_hz;
  simulation::use_device(device, setup);
  core::limit_to_rate(setup.controller);
  Simulation sim(ball().bytes(), setup, std::move(path));
  EXPECT_TRUE(sim.start_result().ok());
  EXPECT_TRUE(sim.arm());
  simulation::Recorder recorder;
  const auto ticks = static_cast<int>(seconds * static_cast<double>(rate_hz));
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
    EXPECT_EQ(faults_along(GetParam(), path, 2.5, 1000.0F), "") << "hand at " << end.transpose();
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
    EXPECT_EQ(faults_along(GetParam(), HandPath(waypoints), 6.0, session % 2 ? 4000.0F : 1000.0F),
              "")
        << "session " << session;
  }
}

// The force grows along a line on which some joint stands still: its motor carries a part of the
// force, but the hand yields by the other joints.
TEST_P(SoundDevice, StaysFaultlessPushedStraightDown) {
  for (const double x : {-0.03, -0.01, 0.01, 0.03}) {
    for (const double y : {-0.02, -0.005, 0.005, 0.02}) {
      const HandPath path({{0.0, {x, y, 0.06}}, {1.0, {x, y, -0.06}}, {1.6, {x, y, -0.06}}});
      EXPECT_EQ(faults_along(GetParam(), path, 1.6, 1000.0F), "") << x << ", " << y;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(FalseFaults, SoundDevice, testing::ValuesIn(core::kDevicePresets));

}  // namespace
}  // namespace tactree::test
