// Fault injection: syntax, and effect on a session.

#include "tactree/simulation/injection.hpp"

#include <gtest/gtest.h>

#include "analytic_shapes.hpp"
#include "tactree/simulation/hand_script.hpp"
#include "tactree/simulation/simulation.hpp"

namespace tactree::test {
namespace {

using core::Fault;
using simulation::InjectedFault;
using simulation::InjectedKind;
using simulation::parse_injection;

TEST(Injection, ReadsEveryScriptPart) {
  const InjectedFault stuck = parse_injection("encoder1:stuck@2.5s");
  EXPECT_EQ(stuck.kind, InjectedKind::kEncoderStuck);
  EXPECT_EQ(stuck.axes, std::vector<std::uint32_t>{0});
  EXPECT_EQ(stuck.from_s, 2.5);
  EXPECT_EQ(stuck.until_s, std::numeric_limits<double>::infinity());
  const InjectedFault jump = parse_injection("encoder:jump=-500@1..1.25s");
  EXPECT_EQ(jump.axes.size(), core::kAxes);
  EXPECT_EQ(jump.value, -500.0);
  EXPECT_EQ(jump.until_s, 1.25);
}

TEST(Injection, ReadsEveryListedKind) {
  for (const simulation::InjectionHelp& help : simulation::injection_kinds()) {
    std::string text(help.name);
    const std::size_t axis = text.find('N');
    if (axis != std::string::npos) {
      text[axis] = '2';
    }
    text += help.about.starts_with("=") ? "=5@1s" : "@1s";
    EXPECT_NO_THROW((void)parse_injection(text)) << text;
  }
}

TEST(Injection, RefusesInvalidScripts) {
  const char* bad[] = {"",
                       "encoder1:stuck",
                       "encoder1@1s",
                       "encoder4:stuck@1s",
                       "encoder0:stuck@1s",
                       "encoder12:stuck@1s",
                       "toaster:stuck@1s",
                       "encoder1:melted@1s",
                       "encoder1:stuck@soon",
                       "encoder1:stuck@-1s",
                       "encoder1:stuck@nan",
                       "encoder1:stuck@2..1s",
                       "encoder1:stuck=3@1s",
                       "encoder1:jump@1s",
                       "encoder1:jump=inf@1s",
                       "encoder1:jump=1e9@1s",
                       "estop1:pressed@1s",
                       "loop:overrun=-1@1s"};
  for (const char* text : bad) {
    EXPECT_THROW((void)parse_injection(text), std::invalid_argument) << text;
  }
}

/// Session of all tests: rubbing over the sheet; its fault, if any, and the tick of the fault.
struct Session {
  Fault fault = Fault::kNone;
  double detected_s = 0.0;
  double force_after_N = 0.0;   // 20 ticks after detection and later
  double force_during_N = 0.0;  // maximum from 1.6 s to 1.9 s
  bool fault_free_end = true;
};

Session run(std::string_view script) {
  static const Shape shape = cos_sheet();
  simulation::Setup setup;
  setup.controller.supervision.supply_monitored = true;
  simulation::Simulation sim(shape.bytes(), setup,
                             simulation::make_script("rub", shape.view(), 4.0));
  EXPECT_TRUE(sim.arm());
  if (!script.empty()) {
    sim.inject(simulation::Injector({parse_injection(script)}));
  }
  Session session;
  int since = 0;
  for (int i = 0; i < 4000; ++i) {
    const simulation::Sample sample = sim.step();
    for (std::uint32_t code = 1; code < core::kFaultCodes && session.fault == Fault::kNone;
         ++code) {
      if (core::has_fault(sample.status.faults, static_cast<Fault>(code))) {
        session.fault = static_cast<Fault>(code);
        session.detected_s = sample.t_s;
      }
    }
    since += session.fault != Fault::kNone ? 1 : 0;
    if (since > 0) {
      session.force_after_N =
          std::max(session.force_after_N, static_cast<double>(core::length(sample.status.force)));
    }
    if (sample.t_s > 1.6 && sample.t_s < 1.9) {
      session.force_during_N =
          std::max(session.force_during_N, static_cast<double>(core::length(sample.status.force)));
    }
    session.fault_free_end = sample.status.faults == 0U;
  }
  return session;
}

struct Expectation {
  const char* script;
  Fault fault;
  double within_s;
};

TEST(Injection, DetectsFaultsAndEndsForce) {
  const Expectation all[] = {
      {"encoder1:disconnected@1.5s", Fault::kEncoderInvalid, 0.001},
      {"encoder3:jump=2000@1.5s", Fault::kEncoderJump, 0.001},
      {"motor:failure@1.5s", Fault::kMotorFault, 0.001},
      {"estop:pressed@1.5s", Fault::kEmergencyStop, 0.001},
      {"enable:off@1.5s", Fault::kEnableMismatch, 0.001},
      {"loop:overrun=2@1.5s", Fault::kDeadlineMissed, 0.002},
      {"supply:sag=12@1.5s", Fault::kSupply, 0.001},
  };
  for (const Expectation& expected : all) {
    const Session session = run(expected.script);
    EXPECT_EQ(session.fault, expected.fault) << expected.script;
    EXPECT_GE(session.detected_s, 1.5 - 1e-9) << expected.script;
    EXPECT_LE(session.detected_s, 1.5 + expected.within_s + 1e-9) << expected.script;
    EXPECT_EQ(session.force_after_N, 0.0) << expected.script;
  }
}

TEST(Injection, HarmlessInjectionsRaiseNoFault) {
  for (const char* script : {"", "motor:weak=5@1.5s", "clock:drift=500@0s", "loop:overrun=1@1.5s",
                             "link:dead@1s", "supply:sag=20@1s"}) {
    EXPECT_EQ(run(script).fault, Fault::kNone) << script;
  }
}

TEST(Injection, LatchedFaultOutlivesCause) {
  const Session session = run("motor:failure@1.5s..1.6s");
  EXPECT_EQ(session.fault, Fault::kMotorFault);
  EXPECT_FALSE(session.fault_free_end);
}

TEST(Injection, DeadManReleaseEndsForce) {
  EXPECT_GT(run("").force_during_N, 0.3);
  const Session session = run("deadman:released@1.5s..2s");
  EXPECT_EQ(session.fault, Fault::kNone);
  EXPECT_EQ(session.force_during_N, 0.0);
}

}  // namespace
}  // namespace tactree::test
