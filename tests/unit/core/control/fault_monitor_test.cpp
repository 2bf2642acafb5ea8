// Every fault of the controller's inputs, in every state.

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <limits>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "controller_rig.hpp"
#include "folders.hpp"

namespace tactree::test {
namespace {

using core::Command;
using core::Fault;
using core::State;

/// A controller brought into a state.
struct InState {
  const char* name;
  State state;
  std::function<void(ControllerRig&)> enter;
};

const std::vector<InState>& states() {
  static const std::vector<InState> all = {
      {"no-model", State::kNoModel,
       [](ControllerRig& s) {
         ASSERT_EQ(s.controller.unload_model(), core::ModelStatus::kOk);
         s.step();
       }},
      {"idle", State::kIdle, [](ControllerRig& s) { s.step(); }},
      {"armed", State::kArmed, [](ControllerRig& s) { s.step(Command::kArm); }},
      {"active", State::kActive,
       [](ControllerRig& s) {
         s.activate();
         s.rest(300);
         s.press(1e-3);
       }},
      {"fault", State::kFault, [](ControllerRig& s) { s.step(static_cast<Command>(77)); }},
  };
  return all;
}

/// A fault that must be detected in the same tick.
struct Trouble {
  Fault fault;
  std::function<void(ControllerRig&)> happen;
};

const std::vector<Trouble>& troubles() {
  static const std::vector<Trouble> all = {
      {Fault::kEmergencyStop, [](ControllerRig& s) { s.input.emergency_stop = true; }},
      {Fault::kEncoderInvalid, [](ControllerRig& s) { s.input.encoders.valid[1] = false; }},
      {Fault::kEncoderJump, [](ControllerRig& s) { s.input.encoders.counts[2] += 1000; }},
      {Fault::kDeadlineMissed, [](ControllerRig& s) { s.input.overruns = 2; }},
      {Fault::kMotorFault, [](ControllerRig& s) { s.input.motors_ok = false; }},
  };
  return all;
}

TEST(Faults, LatchesImmediatelyInEveryState) {
  for (const InState& in : states()) {
    for (const Trouble& trouble : troubles()) {
      ControllerRig session;
      session.step();
      in.enter(session);
      ASSERT_EQ(session.state(), in.state) << in.name;
      const core::Input before = session.input;
      trouble.happen(session);
      const core::Output output = session.step();
      const std::string what = std::string(in.name) + " x " + core::name_of(trouble.fault);
      EXPECT_EQ(session.state(), State::kFault) << what;
      EXPECT_TRUE(core::has_fault(output.status.faults, trouble.fault)) << what;
      EXPECT_TRUE(output.motors.is_zero()) << what;
      EXPECT_FALSE(output.enable) << what;
      EXPECT_TRUE(output.status.summary()) << what;
      session.input = before;
      for (int i = 0; i < 200; ++i) {
        EXPECT_TRUE(session.step().motors.is_zero()) << what;
      }
      EXPECT_TRUE(core::has_fault(session.controller.faults(), trouble.fault)) << what;
    }
  }
}

TEST(Faults, LatchesEmergencyStopBeforeConfiguration) {
  core::Controller controller;
  core::Input input;  // defaults: pressed
  const core::Output output = controller.step(input);
  EXPECT_EQ(output.status.state, State::kFault);
  EXPECT_TRUE(core::has_fault(output.status.faults, Fault::kEmergencyStop));
  EXPECT_TRUE(output.motors.is_zero());
  EXPECT_FALSE(output.enable);
}

TEST(Faults, KeepsPressedEmergencyStopLatched) {
  for (const InState& in : states()) {
    ControllerRig session;
    in.enter(session);
    session.input.emergency_stop = true;
    session.input.dead_man = true;
    for (int round = 0; round < 20; ++round) {
      for (const Command command :
           {Command::kClearFault, Command::kStop, Command::kArm, Command::kArm}) {
        const core::Output output = session.step(command);
        ASSERT_EQ(output.status.state, State::kFault) << in.name;
        ASSERT_FALSE(output.enable) << in.name;
        ASSERT_TRUE(output.motors.is_zero()) << in.name;
      }
    }
  }
}

TEST(Faults, LatchesTwoCloseOverruns) {
  for (const int apart : {1, 50, 100, 101, 200}) {
    ControllerRig session;
    session.activate();
    session.input.overruns = 1;
    session.step();
    EXPECT_EQ(session.state(), State::kActive);
    session.input.overruns = 0;
    for (int i = 1; i < apart; ++i) {
      session.step();
    }
    session.input.overruns = 1;
    const core::Output output = session.step();
    EXPECT_EQ(session.state(), apart <= 100 ? State::kFault : State::kActive) << apart;
    EXPECT_EQ(output.status.overruns, 2U);
  }
}

TEST(Faults, ExcusesStorageOverrunsWhileUnpowered) {
  ControllerRig session;
  session.step();
  session.input.storage_busy = true;
  session.input.overruns = 5;
  EXPECT_EQ(session.step().status.overruns, 0U);
  EXPECT_EQ(session.state(), State::kIdle);
  session.input.storage_busy = false;
  EXPECT_EQ(session.step().status.overruns, 5U);
  EXPECT_EQ(session.state(), State::kFault);

  ControllerRig active;
  active.activate();
  active.input.storage_busy = true;
  active.input.overruns = 2;
  EXPECT_EQ(active.step().status.overruns, 2U);
  EXPECT_EQ(active.state(), State::kFault);
}

TEST(Faults, StopsOnRequiredLinkLoss) {
  for (const bool required : {false, true}) {
    core::Configuration configuration;
    configuration.link.required = required;
    configuration.link.timeout_s = 0.02F;
    ControllerRig session(configuration);
    session.activate();
    ASSERT_EQ(session.state(), State::kActive);
    session.input.link_alive = false;
    int ticks = 0;
    while (session.state() == State::kActive && ticks < 500) {
      session.step();
      ++ticks;
    }
    EXPECT_EQ(session.state(), required ? State::kFault : State::kActive);
    if (required) {
      EXPECT_EQ(ticks, 21);  // older than 20 ms
      EXPECT_TRUE(core::has_fault(session.controller.faults(), Fault::kLinkLost));
    }
  }
}

// A program that only repeats the arm command does not supervise the session.
TEST(Faults, IgnoresArmCommandAsHeartbeat) {
  core::Configuration configuration;
  configuration.link.required = true;
  configuration.link.timeout_s = 0.02F;
  ControllerRig session(configuration);
  session.activate();
  session.input.link_alive = false;
  for (int i = 0; i < 25; ++i) {
    session.step(Command::kArm);
  }
  EXPECT_EQ(session.state(), State::kFault);
  EXPECT_TRUE(core::has_fault(session.controller.faults(), Fault::kLinkLost));
}

TEST(Faults, ReportsLinkLossOnceArmed) {
  core::Configuration configuration;
  configuration.link.required = true;
  ControllerRig session(configuration);
  session.input.link_alive = false;
  session.rest(1000);
  EXPECT_EQ(session.state(), State::kIdle);
  session.step(Command::kArm);
  session.step();
  EXPECT_EQ(session.state(), State::kFault);
}

TEST(Faults, DetectsEnableLineMismatch) {
  ControllerRig stuck_off;
  stuck_off.enable_follows = false;
  stuck_off.step(Command::kArm);
  int ticks = 0;
  while (stuck_off.state() == State::kArmed && ticks < 500) {
    stuck_off.step();
    ++ticks;
  }
  EXPECT_TRUE(core::has_fault(stuck_off.controller.faults(), Fault::kEnableMismatch));
  EXPECT_EQ(ticks, 51);  // longer than 50 ms

  ControllerRig welded;  // power although nobody asked for it
  welded.enable_follows = false;
  welded.input.enable_read_back = true;
  welded.rest(60);
  EXPECT_TRUE(core::has_fault(welded.controller.faults(), Fault::kEnableMismatch));
}

TEST(Faults, ReportsPowerLossImmediately) {
  ControllerRig session;
  session.activate();
  ASSERT_EQ(session.state(), State::kActive);
  session.enable_follows = false;
  session.input.enable_read_back = false;
  EXPECT_TRUE(session.step().motors.is_zero());
  EXPECT_EQ(session.state(), State::kFault);
}

TEST(Faults, ReportsUnknownCommand) {
  ControllerRig session;
  session.step(static_cast<Command>(5));
  EXPECT_EQ(session.state(), State::kFault);
  EXPECT_TRUE(core::has_fault(session.controller.faults(), Fault::kUnexpectedEvent));
}

TEST(Faults, ReportsLoadAndProbe) {
  core::Configuration configuration;
  configuration.model_origin_m = {0.001F, -0.002F, 0.004F};
  ControllerRig session(configuration);
  session.input.load = 0.75F;
  const core::Status status = session.step().status;
  EXPECT_EQ(status.load, 0.75F);
  EXPECT_NEAR(status.probe.x, -0.001F, 2e-5F);
  EXPECT_NEAR(status.probe.y, 0.002F, 2e-5F);
  EXPECT_NEAR(status.probe.z, 0.006F, 2e-5F);
}

TEST(Faults, AcceptsCounterWrapAround) {
  core::Configuration configuration;
  configuration.device.home_count[0] = 0x7FFFFFFF;
  ControllerRig session(configuration);
  session.activate();
  for (int i = -50; i < 50; ++i) {
    session.move(i * 3e-5, 0.0, 0.01);
    const core::Output output = session.step();
    ASSERT_EQ(session.state(), State::kActive);
    ASSERT_NEAR(output.status.probe.x, static_cast<float>(i) * 3e-5F, 4e-5F);
  }
}

std::set<std::string> pages() {
  std::set<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(source_folder() / "docs/faults")) {
    names.insert(entry.path().stem().string());
  }
  names.erase("README");
  return names;
}

TEST(Faults, DocumentsEveryFaultAndLimit) {
  std::set<std::string> wanted;
  for (std::uint32_t code = 1; code < core::kFaultCodes; ++code) {
    wanted.insert(core::name_of(static_cast<Fault>(code)));
  }
  for (std::uint32_t i = 0; i < core::kLimits; ++i) {
    wanted.insert(std::string("limit-") + core::name_of(static_cast<core::Limit>(1U << i)));
  }
  EXPECT_EQ(pages(), wanted);
  for (const std::string& name : pages()) {
    std::ifstream file(source_folder() / "docs/faults" / (name + ".md"));
    const std::string text((std::istreambuf_iterator<char>(file)), {});
    EXPECT_NE(text.find("## Likely causes\n- "), std::string::npos) << name;
    EXPECT_NE(text.find("## What to do\n"), std::string::npos) << name;
  }
  EXPECT_EQ(std::string(core::name_of(static_cast<core::Limit>(3))), "unknown");
}

TEST(Faults, ReportsSupplyOutsideRange) {
  core::Configuration configuration;
  configuration.supervision.supply_monitored = true;
  for (const float volts : {17.9F, 30.1F, 0.0F, -24.0F, std::numeric_limits<float>::quiet_NaN(),
                            std::numeric_limits<float>::infinity()}) {
    ControllerRig session(configuration);
    session.input.supply_V = volts;
    session.step();
    EXPECT_EQ(session.state(), State::kIdle);  // off: it may be switched off, too
    session.input.supply_V = 24.0F;
    session.activate();
    ASSERT_EQ(session.state(), State::kActive);
    session.input.supply_V = volts;
    const core::Output output = session.step();
    EXPECT_TRUE(core::has_fault(output.status.faults, Fault::kSupply)) << volts;
    EXPECT_TRUE(output.motors.is_zero());
    EXPECT_FALSE(output.enable);
  }
}

TEST(Faults, KeepsFirstFaultReported) {
  ControllerRig session;
  session.input.emergency_stop = true;
  session.step();
  session.input.emergency_stop = false;
  session.input.encoders.valid[0] = false;
  session.step();
  EXPECT_TRUE(core::has_fault(session.controller.faults(), Fault::kEmergencyStop));
  EXPECT_TRUE(core::has_fault(session.controller.faults(), Fault::kEncoderInvalid));
}

TEST(Faults, AcceptsSupplyAtRangeEnds) {
  core::Configuration configuration;
  configuration.supervision.supply_monitored = true;
  for (const float volts :
       {configuration.supervision.supply_min_V, configuration.supervision.supply_max_V}) {
    ControllerRig session(configuration);
    session.input.supply_V = volts;
    session.activate();
    session.step();
    EXPECT_EQ(session.state(), State::kActive) << volts;
  }
}

/// A hand in free space that holds one axis still while a force of the application swings along
/// another; the other axes tremble by a count.
class StuckEncoder {
 public:
  explicit StuckEncoder(const core::Configuration& configuration = StuckEncoder::configuration())
      : session_(configuration, core::HomingMethod::kGivenPose) {
    session_.step(Command::kHome);
    session_.activate();
    for (std::uint32_t tick = 0; tick < 100; ++tick) {
      tremble(tick, core::kAxes);
      session_.step();
    }
  }

  /// Number of ticks until a fault; none: no fault.
  std::optional<std::uint32_t> ticks_to_fault(std::uint32_t held, std::uint32_t pushed,
                                              std::uint32_t ticks) {
    for (std::uint32_t tick = 1; tick <= ticks; ++tick) {
      tremble(tick, held);
      const float force = (tick / 20U % 2U == 0U ? 0.4F : -0.4F) * kForce_N;
      session_.input.added_force = {
          {pushed == 0 ? force : 0.0F, pushed == 1 ? force : 0.0F, pushed == 2 ? force : 0.0F}, 1};
      if (core::has_fault(session_.step().status.faults, Fault::kEncoderStuck)) {
        return tick;
      }
    }
    return std::nullopt;
  }

  ControllerRig& session() { return session_; }
  static core::Configuration configuration() {
    core::Configuration configuration;
    configuration.supervision.stuck_s = 0.1F;
    configuration.limits.ramp_s = 0.01F;
    return configuration;
  }
  static constexpr float kForce_N = core::ForceLimits{}.force_max_N;
  static constexpr std::uint32_t kTicks = 100;  // stuck_s of the configuration below

 private:
  void tremble(std::uint32_t tick, std::uint32_t held) {
    for (std::uint32_t axis = 0; axis < core::kAxes; ++axis) {
      session_.input.encoders.counts[axis] += axis == held ? 0 : (tick % 2U == 0U ? 1 : -1);
    }
  }

  ControllerRig session_;
};

TEST(Faults, DetectsStuckEncoderUnderEffort) {
  for (std::uint32_t held = 0; held < core::kAxes; ++held) {
    for (std::uint32_t pushed = 0; pushed < core::kAxes; ++pushed) {
      const auto ticks = StuckEncoder().ticks_to_fault(held, pushed, 3U * StuckEncoder::kTicks);
      ASSERT_EQ(ticks.has_value(), held == pushed) << held << " " << pushed;
      if (ticks) {
        EXPECT_GE(*ticks, StuckEncoder::kTicks);
        EXPECT_LE(*ticks, StuckEncoder::kTicks + 2U);
      }
    }
  }
}

TEST(Faults, ChecksEncoderAgainstOwnAxis) {
  for (std::uint32_t held = 0; held < core::kAxes; ++held) {
    core::Configuration configuration = StuckEncoder::configuration();
    for (std::uint32_t axis = 0; axis < core::kAxes; ++axis) {
      configuration.motors.effort_max[axis] = axis == held ? 4.0F : 40.0F;
    }
    StuckEncoder stuck(configuration);
    ASSERT_EQ(stuck.session().status, core::ConfigurationStatus::kOk);
    ASSERT_TRUE(stuck.session().controller.homed());
    EXPECT_TRUE(stuck.ticks_to_fault(held, held, 3U * StuckEncoder::kTicks)) << held;
    EXPECT_FALSE(stuck.session().controller.homed());  // it lost its place while it stood still
  }
}

TEST(Faults, ChecksStuckEncodersWhileActive) {
  StuckEncoder stuck;
  ASSERT_FALSE(stuck.ticks_to_fault(0, 0, StuckEncoder::kTicks - 10U));
  stuck.session().step(Command::kStop);
  ASSERT_EQ(stuck.session().state(), State::kIdle);
  stuck.session().input.dead_man = false;
  stuck.session().activate();
  ASSERT_EQ(stuck.session().state(), State::kActive);
  EXPECT_FALSE(stuck.ticks_to_fault(0, 0, StuckEncoder::kTicks - 10U));
  EXPECT_TRUE(stuck.ticks_to_fault(0, 0, 30U));
}

TEST(Faults, RespectsConfiguredStuckTime) {
  core::Configuration configuration = StuckEncoder::configuration();
  configuration.supervision.stuck_s = 0.25F;
  const auto ticks = StuckEncoder(configuration).ticks_to_fault(0, 0, 400U);
  ASSERT_TRUE(ticks.has_value());
  EXPECT_GE(*ticks, 250U);
  EXPECT_LE(*ticks, 252U);
}

/// The monitor's answer to axis 1 of a device at rest under a force of changing size, N.
bool is_stuck_under(const core::DevicePose& pose, core::Vec3 direction) {
  core::Configuration configuration = StuckEncoder::configuration();
  configuration.motors.effort_max[1] = 1.0F;
  core::FaultMonitor monitor;
  monitor.configure(configuration);
  core::EncoderReading reading;
  bool stuck = false;
  for (std::int32_t tick = 0; tick < 400; ++tick) {
    reading.counts[0] = reading.counts[2] = tick;
    const float size = 0.1F * static_cast<float>(tick);
    stuck = stuck || monitor.update_encoders(reading, configuration, pose.effort_per_force,
                                             size * direction) != 0U;
  }
  return stuck;
}

// The motor of an axis may carry a force that moves other axes only.
TEST(Faults, WatchesForceThatMovesAxis) {
  core::DevicePose pose;
  pose.effort_per_force = {{{1.0F, 0.0F, 0.0F}, {0.0F, 0.2F, 0.2F}, {0.0F, 0.0F, 0.2F}}};
  const core::Vec3 up = {0.0F, 0.0F, 1.0F};
  EXPECT_GT((pose.effort_per_force * up).y, 0.1F) << "its motor carries a part";
  EXPECT_FALSE(is_stuck_under(pose, up)) << "which axis 2 alone yields to";
  EXPECT_TRUE(is_stuck_under(pose, {0.0F, 1.0F, 0.0F}));
  EXPECT_FALSE(is_stuck_under(pose, {1.0F, 0.0F, 0.0F}));
}

TEST(Faults, WatchesNoEncoderAtEndOfRange) {
  for (const bool at_end : {false, true}) {
    core::Configuration configuration = StuckEncoder::configuration();
    core::DeviceModel& device = configuration.device;
    device.joint_min[0] = -0.1F;
    device.joint_max[0] = 0.1F;
    device.joint_margin[0] = 0.01F;
    device.home_position[0] = device.joint_max[0] - (at_end ? 0.5F : 2.0F) * device.joint_margin[0];
    StuckEncoder stuck(configuration);
    ASSERT_EQ(stuck.session().status, core::ConfigurationStatus::kOk);
    ASSERT_EQ(stuck.session().state(), State::kActive);
    EXPECT_EQ(stuck.ticks_to_fault(0, 0, 3U * StuckEncoder::kTicks).has_value(), !at_end);
  }
}

TEST(Faults, NamesEveryCodeUniquely) {
  std::set<std::string> names;
  for (std::uint32_t code = 0; code < core::kFaultCodes; ++code) {
    names.insert(core::name_of(static_cast<Fault>(code)));
  }
  EXPECT_EQ(names.size(), core::kFaultCodes);
  EXPECT_STREQ(core::name_of(static_cast<Fault>(1)), "emergency-stop");
  EXPECT_STREQ(core::name_of(static_cast<Fault>(10)), "model-incomplete");
  EXPECT_EQ(std::string(core::name_of(static_cast<Fault>(99))), "unknown");
}

}  // namespace
}  // namespace tactree::test
