// Record of the last ticks after a fault.

#include "tactree/core/control/flight_recorder.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "controller_rig.hpp"

namespace tactree::test {
namespace {

using core::Command;
using core::Fault;
using core::FlightRecord;
using core::FlightRecorder;

TEST(FlightRecorder, KeepsLastTicksRounded) {
  ControllerRig session;
  session.activate();
  session.rest(1000);
  const core::Output pressed = session.press(1e-3);
  const FlightRecorder& recorder = session.controller.recorder();
  ASSERT_EQ(recorder.count(), FlightRecorder::kTicks);
  EXPECT_EQ(recorder.last_tick(), pressed.status.tick);
  const FlightRecord& last = recorder.record(0);
  EXPECT_NEAR(last.probe[2] / FlightRecord::kMetre, pressed.status.probe.z, 1.1e-5F);
  EXPECT_NEAR(last.proxy[2] / FlightRecord::kDepth,
              pressed.status.rendering.proxy.z - pressed.status.probe.z, 2.6e-5F);
  EXPECT_NEAR(last.force[2] / FlightRecord::kNewton, pressed.status.force.z, 6e-4F);
  EXPECT_EQ(last.state_of(), core::State::kActive);
  EXPECT_TRUE(last.in_contact());
  EXPECT_FALSE(recorder.record(400).in_contact());
  EXPECT_EQ(recorder.snapshot().faults, 0U);
}

TEST(FlightRecorder, StopsAtFaultWithSnapshot) {
  ControllerRig session;
  session.activate();
  const core::Output pressed = session.press(1e-3);
  session.input.motors_ok = false;
  const core::Output faulty = session.step();
  session.rest(5000);
  const FlightRecorder& recorder = session.controller.recorder();
  const core::FaultSnapshot& snapshot = recorder.snapshot();
  EXPECT_EQ(snapshot.faults, core::fault_bit(Fault::kMotorFault));
  EXPECT_EQ(snapshot.tick, faulty.status.tick);
  EXPECT_EQ(snapshot.force, pressed.status.force);
  EXPECT_EQ(snapshot.probe, pressed.status.probe);
  EXPECT_EQ(recorder.last_tick(), faulty.status.tick + FlightRecorder::kAfterFault - 1U);
  EXPECT_TRUE(recorder.record(FlightRecorder::kAfterFault).in_contact());  // just before
}

TEST(FlightRecorder, ContinuesAfterClearedFault) {
  ControllerRig session;
  session.step(static_cast<Command>(77));
  session.rest(100);
  session.step(Command::kClearFault);
  const core::Output output = session.step(Command::kStop);
  EXPECT_EQ(session.controller.recorder().snapshot().faults, 0U);
  EXPECT_EQ(session.controller.recorder().last_tick(), output.status.tick);
}

TEST(FlightRecorder, KeepsFirstSnapshot) {
  ControllerRig session;
  session.input.motors_ok = false;
  const core::Output first = session.step();
  session.input.emergency_stop = true;
  session.step();
  EXPECT_EQ(session.controller.recorder().snapshot().faults, core::fault_bit(Fault::kMotorFault));
  EXPECT_EQ(session.controller.recorder().snapshot().tick, first.status.tick);
}

TEST(FlightRecorder, AcceptsEveryFloat) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  constexpr float kEndless = std::numeric_limits<float>::infinity();
  FlightRecorder recorder;
  core::Rendering rendering;
  rendering.proxy = {kEndless, 0.0F, 0.0F};
  for (const float load : {kNan, kEndless, 3.0F}) {
    recorder.add({core::State::kIdle,
                  0U,
                  1U,
                  {kNan, 0.0F, 0.0F},
                  {},
                  {1e30F, -1e30F, 0.0F},
                  rendering,
                  load});
    EXPECT_EQ(recorder.record(0).load, 255);
  }
  EXPECT_EQ(recorder.record(0).probe[0], 32767);
  EXPECT_EQ(recorder.record(0).force[0], 32767);
  EXPECT_EQ(recorder.record(0).force[1], -32767);
}

}  // namespace
}  // namespace tactree::test
