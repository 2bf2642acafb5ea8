#pragma once
// A session of a board that stands alone, from power-up to a cleared fault, operated by its button.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "tactree/simulation/user.hpp"

namespace tactree::test {

struct PanelSession {
  std::vector<simulation::Sample> samples;
  std::uint32_t trace_crc32 = 0;
};

/// Of a device that is not homed and a board without an application.
inline simulation::Setup standing_alone(simulation::Setup setup) {
  setup.homed = false;
  setup.controller.link.required = false;
  setup.controller.link.may_command = false;
  return setup;
}

/// Homes, arms, touches, stops and clears the fault of missed deadlines. The path of the hand takes
/// 2 s.
inline PanelSession operate_by_panel(simulation::Simulation& sim, float rate_hz) {
  EXPECT_TRUE(sim.start_result().ok());
  simulation::User user(static_cast<double>(rate_hz), 2.0,
                        {{0.1, 1.2}, {1.8, 2.9}, {3.8, 3.85}, {5.5, 6.6}});
  sim.inject(simulation::Injector({simulation::parse_injection("loop:overrun=2@4s..4.01s")}));
  PanelSession session;
  simulation::Recorder recorder;
  while (sim.time_s() < 7.0) {
    session.samples.push_back(user.step(sim));
    recorder.add(session.samples.back());
  }
  sim.finish();
  session.trace_crc32 = recorder.summary().trace_crc32;
  return session;
}

/// The state, and whether the device is homed, in the order of the session.
inline std::vector<std::string> states_of(const PanelSession& session) {
  std::vector<std::string> states;
  for (const simulation::Sample& sample : session.samples) {
    const bool homed = (sample.status.limits & core::limit_bit(core::Limit::kNotHomed)) == 0U;
    const std::string state =
        std::string(core::name_of(sample.status.state)) + (homed ? "" : ", not homed");
    if (states.empty() || states.back() != state) {
      states.push_back(state);
    }
  }
  return states;
}

/// Number of times that the lamp goes on in a second of the session.
inline int flashes(const PanelSession& session, double from_s) {
  bool was_lit = false;
  int count = 0;
  for (const simulation::Sample& sample : session.samples) {
    if (sample.t_s >= from_s && sample.t_s < from_s + 1.0) {
      count += sample.lamp && !was_lit ? 1 : 0;
    }
    was_lit = sample.lamp;
  }
  return count;
}

inline void expect_operated(const PanelSession& session) {
  EXPECT_EQ(states_of(session), (std::vector<std::string>{"idle, not homed", "idle", "armed",
                                                          "active", "idle", "fault", "idle"}));
  const auto touched = [](const simulation::Sample& sample) {
    return sample.status.rendering.in_contact && !(sample.status.force == core::Vec3{});
  };
  EXPECT_GT(std::count_if(session.samples.begin(), session.samples.end(), touched), 100);
  for (const simulation::Sample& sample : session.samples) {
    const bool active = sample.status.state == core::State::kActive;
    ASSERT_TRUE(active || sample.status.force == core::Vec3{}) << "force at " << sample.t_s << " s";
    ASSERT_TRUE(!active || sample.lamp) << "the lamp is off at " << sample.t_s << " s";
  }
  const simulation::Sample& failed = session.samples[static_cast<std::size_t>(
      static_cast<double>(session.samples.size()) * 5.0 / 7.0)];
  EXPECT_EQ(failed.status.faults, core::fault_bit(core::Fault::kDeadlineMissed));
  EXPECT_EQ(flashes(session, 4.0), static_cast<int>(core::Fault::kDeadlineMissed));
  EXPECT_EQ(flashes(session, 4.99), 0) << "the pause after the code";
}

}  // namespace tactree::test
