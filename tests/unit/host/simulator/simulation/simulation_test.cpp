// The whole chain: hand, device, board, controller.

#include "tactree/simulation/simulation.hpp"

#include <gtest/gtest.h>

#include "analytic_shapes.hpp"
#include "tactree/simulation/hand_script.hpp"

namespace tactree::test {
namespace {

using simulation::HandPath;
using simulation::Recorder;
using simulation::Sample;
using SimSetup = simulation::Setup;
using simulation::Simulation;
using simulation::Summary;

const Shape& model() {
  static const Shape shape = cos_sheet();
  return shape;
}

Summary run(const SimSetup& setup, const std::string& script, int ticks) {
  const double seconds = ticks / static_cast<double>(setup.controller.rate_hz);
  Simulation sim(model().bytes(), setup, simulation::make_script(script, model().view(), seconds));
  EXPECT_TRUE(sim.start_result().ok());
  EXPECT_TRUE(sim.arm());
  Recorder recorder;
  for (int i = 0; i < ticks; ++i) {
    recorder.add(sim.step());
  }
  return recorder.summary();
}

TEST(Simulation, RubbingGivesFaultlessContact) {
  const Summary s = run({}, "rub", 5000);
  EXPECT_EQ(s.ticks, 5000U);
  EXPECT_GT(s.contact_ticks, 3500U);
  EXPECT_LT(s.contact_ticks, 5000U);
  EXPECT_GT(s.force_max_N, 0.3);
  EXPECT_LE(s.force_max_N, 8.0);
  EXPECT_LE(s.force_step_max_N, 0.25);  // touching down at 0.1 m/s; slewing may be 2 N
  EXPECT_GT(s.penetration_max_m, 0.5e-3);
  EXPECT_LT(s.penetration_max_m, 4e-3);
  EXPECT_TRUE(s.faults.empty());
  EXPECT_EQ(s.overruns, 0U);
}

TEST(Simulation, RunsScriptsInEverySetup) {
  for (const float rate : {500.0F, 1000.0F, 4000.0F, 10000.0F}) {
    for (const core::RenderMode mode : {core::RenderMode::kSurface, core::RenderMode::kPaper}) {
      for (const std::string& script : simulation::script_names()) {
        SimSetup setup;
        setup.controller.rate_hz = rate;
        setup.controller.mode = mode;
        const Summary s = run(setup, script, static_cast<int>(2.0F * rate));
        EXPECT_TRUE(s.faults.empty()) << script << " at " << rate;
        EXPECT_EQ(s.contact_ticks > 0, script != "hover") << script << " at " << rate;
      }
    }
  }
}

TEST(Simulation, SameRunGivesSameChecksum) {
  const Summary first = run({}, "rub", 2000);
  const Summary second = run({}, "rub", 2000);
  EXPECT_EQ(first.trace_crc32, second.trace_crc32);
  SimSetup other;
  other.controller.contact.stiffness_N_m = 501.0F;
  EXPECT_NE(run(other, "rub", 2000).trace_crc32, first.trace_crc32);
}

TEST(Simulation, HeldTipIsInEquilibrium) {
  // The target rests 5 mm below a plane: the springs of hand and wall share the displacement.
  const Shape shape = plane();
  SimSetup setup;
  setup.plant.device.coulomb_N = 0.0;
  const HandPath path({{0.0, {0.0, 0.0, 0.005}}, {0.2, {0.0, 0.0, -0.005}}});
  Simulation sim(shape.bytes(), setup, path);
  ASSERT_TRUE(sim.arm());
  Sample sample;
  for (int i = 0; i < 2000; ++i) {
    sample = sim.step();
  }
  const double expected = 300.0 * 500.0 / 800.0 * 0.005;
  EXPECT_NEAR(static_cast<double>(sample.status.force.z), expected, 0.02);
}

TEST(Simulation, RecordsFaultAndTick) {
  Simulation sim(model().bytes(), {}, simulation::make_script("rub", model().view(), 2.0));
  ASSERT_TRUE(sim.arm());
  Recorder recorder;
  for (int i = 0; i < 1000; ++i) {
    if (i == 700) {
      sim.board().safety_inputs().press_emergency_stop(true);
    }
    const Sample sample = sim.step();
    recorder.add(sample);
    if (i >= 700) {
      ASSERT_EQ(sample.status.force, core::Vec3{});
    }
  }
  const Summary s = recorder.summary();
  ASSERT_EQ(s.faults.size(), 1U);
  EXPECT_EQ(s.faults[0].fault, core::Fault::kEmergencyStop);
  EXPECT_EQ(s.faults[0].tick, 700U);
}

TEST(Simulation, LimitsForceOfDeviceFaults) {
  using hal::sim::EncoderFault;
  using hal::sim::MotorFault;
  const auto run_with = [](auto&& inject) {
    Simulation sim(model().bytes(), {}, simulation::make_script("rub", model().view(), 3.0));
    EXPECT_TRUE(sim.arm());
    Recorder recorder;
    for (int i = 0; i < 3000; ++i) {
      if (i == 1000) {
        inject(sim.board());
      }
      recorder.add(sim.step());
    }
    return recorder.summary();
  };
  const Summary jump = run_with([](auto& b) { b.encoders().jump(2, 700); });
  ASSERT_EQ(jump.faults.size(), 1U);
  EXPECT_EQ(jump.faults[0].fault, core::Fault::kEncoderJump);
  EXPECT_EQ(jump.faults[0].tick, 1000U);
  const Summary broken =
      run_with([](auto& b) { b.encoders().inject(0, EncoderFault::kDisconnected); });
  ASSERT_FALSE(broken.faults.empty());
  EXPECT_EQ(broken.faults[0].fault, core::Fault::kEncoderInvalid);
  for (const MotorFault fault : {MotorFault::kDead, MotorFault::kStuck, MotorFault::kReversed}) {
    EXPECT_LE(run_with([=](auto& b) { b.motors().inject(2, fault); }).force_max_N, 8.0);
  }
  EXPECT_LE(run_with([](auto& b) { b.encoders().inject(2, EncoderFault::kStuck); }).force_max_N,
            8.0);
}

TEST(Simulation, LatencyReachesController) {
  for (const std::uint32_t latency : {0U, 3U}) {
    SimSetup setup;
    setup.board.encoders.latency_ticks = latency;
    const HandPath path({{0.0, {0.0, 0.0, 0.03}}, {1.0, {0.1, 0.0, 0.03}}});
    Simulation sim(model().bytes(), setup, path);
    ASSERT_TRUE(sim.arm());
    Sample sample;
    for (int i = 0; i < 800; ++i) {
      sample = sim.step();
    }
    const double behind = sample.tip_m.x() - static_cast<double>(sample.status.probe.x);
    EXPECT_GE(behind, latency * 1e-4 - 1e-6);
    EXPECT_LE(behind, latency * 1e-4 + 31e-6);
  }
}

}  // namespace
}  // namespace tactree::test
