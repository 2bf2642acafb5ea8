// The controller on a board computes the same trace as on the host, to the bit, in every run.

#include <memory>
#include <optional>
#include <vector>

#include "boards_for_test.hpp"
#include "tactree/simulation/hand_script.hpp"
#include "tactree/simulation/scene_target.hpp"
#include "tactree/simulation/simulation.hpp"

namespace tactree::test {
namespace {

constexpr int kTicks = 2000;

struct RunResult {
  simulation::Summary summary;
  emulation::InstructionCounts counts;
};

simulation::Summary record(simulation::Simulation& sim) {
  EXPECT_TRUE(sim.start_result().ok());
  EXPECT_TRUE(sim.arm());
  simulation::Recorder recorder;
  for (int i = 0; i < kTicks; ++i) {
    recorder.add(sim.step());
  }
  sim.finish();
  return recorder.summary();
}

simulation::HandPath path() { return simulation::make_script("rub", touched_shape().view(), 2.0); }

simulation::Setup setup_of(core::RenderMode mode) {
  simulation::Setup setup;
  setup.controller.mode = mode;
  setup.controller.contact.stiffness_N_m =
      612.3F;  // a value that is not a power of two shows lost bits
  setup.controller.contact.static_friction = 0.37F;
  setup.board.encoders.latency_ticks = 1;
  setup.board.motors.latency_ticks = 1;
  return setup;
}

simulation::Summary run_on_host(const simulation::Setup& setup) {
  simulation::Simulation sim(touched_shape().bytes(), setup, path());
  return record(sim);
}

/// It rotates, moves sideways and towards the hand; for a while it is absent.
simulation::SceneBody moving_body() {
  const Eigen::Isometry3d begin(Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitY()));
  simulation::SceneBody body;
  body.blob = touched_shape().bytes();
  body.path = simulation::BodyPath(begin, {0.003, -0.002, 0.001}, {0.05, -0.1, 0.8});
  body.from_s = -10.0;
  body.until_s = 1.6;
  return body;
}

simulation::Summary run_on_host(const simulation::Setup& setup, const simulation::SceneBody& body) {
  auto target = std::make_unique<simulation::SceneTarget>(
      std::vector{body}, simulation::Simulation::arming_ticks(setup));
  simulation::Simulation sim(touched_shape().bytes(), setup, path(), std::move(target));
  return record(sim);
}

RunResult run_on(const emulation::BoardDescription& board, emulation::EmulationOptions options,
                 const simulation::Setup& setup,
                 const std::optional<simulation::SceneBody>& body = std::nullopt) {
  options.uncounted_ticks = simulation::Simulation::arming_ticks(setup);
  auto emulator =
      std::make_unique<emulation::EmulatedTarget>(board, touched_shape().bytes(), options);
  const emulation::EmulatedTarget& emulated = *emulator;
  std::unique_ptr<simulation::Target> target = std::move(emulator);
  if (body) {
    target = std::make_unique<simulation::LinkedBodyTarget>(std::move(target), *body,
                                                            options.uncounted_ticks);
  }
  simulation::Simulation sim(touched_shape().bytes(), setup, path(), std::move(target));
  RunResult run;
  run.summary = record(sim);
  run.counts = emulated.instruction_counts().value();
  return run;
}

class Trace : public OnBoard {};
TACTREE_ON_EVERY_BOARD(Trace);

TEST_P(Trace, EqualsHostInBothModes) {
  for (const core::RenderMode mode : {core::RenderMode::kSurface, core::RenderMode::kPaper}) {
    const simulation::Setup setup = setup_of(mode);
    const simulation::Summary expected = run_on_host(setup);
    const simulation::Summary found = run_on(board(), options(), setup).summary;
    EXPECT_GT(expected.contact_ticks, 10U);
    EXPECT_EQ(found.trace_crc32, expected.trace_crc32);
    EXPECT_EQ(found.contact_ticks, expected.contact_ticks);
    EXPECT_EQ(found.penetration_max_m, expected.penetration_max_m);
    EXPECT_EQ(found.overruns, 0U);
    EXPECT_TRUE(found.faults.empty());
  }
}

TEST_P(Trace, EqualsHostWithMovingBody) {
  for (const core::RenderMode mode : {core::RenderMode::kSurface, core::RenderMode::kPaper}) {
    const simulation::Setup setup = setup_of(mode);
    const simulation::Summary expected = run_on_host(setup, moving_body());
    const simulation::Summary found = run_on(board(), options(), setup, moving_body()).summary;
    EXPECT_GT(expected.contact_ticks, 100U);
    EXPECT_NE(expected.trace_crc32, run_on_host(setup).trace_crc32);
    EXPECT_EQ(found.trace_crc32, expected.trace_crc32);
    EXPECT_EQ(found.contact_ticks, expected.contact_ticks);
    EXPECT_EQ(found.penetration_max_m, expected.penetration_max_m);
    EXPECT_EQ(found.bodies[0].torque_max_Nm, expected.bodies[0].torque_max_Nm);
    EXPECT_TRUE(found.faults.empty());
  }
}

TEST_P(Trace, EqualsHostAtFourKilohertz) {
  simulation::Setup setup = setup_of(core::RenderMode::kSurface);
  setup.controller.rate_hz = 4000.0F;
  simulation::Simulation on_host(touched_shape().bytes(), setup, path());
  EXPECT_EQ(run_on(board(), options(), setup).summary.trace_crc32, record(on_host).trace_crc32);
}

TEST_P(Trace, RepeatsInstructionCounts) {
  const simulation::Setup setup = setup_of(core::RenderMode::kSurface);
  const RunResult first = run_on(board(), options(), setup);
  const RunResult second = run_on(board(), options(), setup);
  EXPECT_EQ(first.counts.ticks, static_cast<std::uint64_t>(kTicks));
  EXPECT_GT(first.counts.mean(), 500.0);
  EXPECT_GE(first.counts.max, first.counts.mean());
  EXPECT_GT(first.counts.start, 10000U);
  EXPECT_EQ(second.counts.checksum, first.counts.checksum);
  EXPECT_EQ(second.counts.total, first.counts.total);
  EXPECT_EQ(second.counts.max, first.counts.max);
  EXPECT_EQ(second.counts.start, first.counts.start);
  std::uint64_t sum = 0;
  for (const emulation::FunctionCount& function : first.counts.functions) {
    sum += function.total;
  }
  EXPECT_EQ(sum, first.counts.total);
}

// On a core a hundred times too slow, ticks end late: a fault, and no force.
TEST_P(Trace, FaultsOnSlowBoard) {
  emulation::EmulationOptions slow = options();
  slow.instruction_shift = 10;
  auto target = std::make_unique<emulation::EmulatedTarget>(board(), touched_shape().bytes(), slow);
  simulation::Simulation sim(touched_shape().bytes(), {}, path(), std::move(target));
  EXPECT_FALSE(sim.arm());
  const core::Status status = sim.step().status;
  EXPECT_EQ(status.state, core::State::kFault);
  EXPECT_TRUE(core::has_fault(status.faults, core::Fault::kDeadlineMissed));
  EXPECT_GT(status.overruns, 10U);
  EXPECT_EQ(status.force, core::Vec3{});
  sim.finish();
}

}  // namespace
}  // namespace tactree::test
