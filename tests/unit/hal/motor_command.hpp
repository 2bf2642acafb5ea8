#pragma once
// A command for motors, constructed by the safety gate.

#include <gtest/gtest.h>

#include "tactree/core/safety/safety_gate.hpp"

namespace tactree::test {

/// Of the first axis; at most 8 N.
inline core::MotorCommand command_of(float x) {
  constexpr core::Mat3 kIdentity{{{1.0F, 0.0F, 0.0F}, {0.0F, 1.0F, 0.0F}, {0.0F, 0.0F, 1.0F}}};
  core::SafetyGate gate;
  core::GateLimits limits;
  limits.ramp_ticks = 2;
  limits.slew_N_per_tick = 16.0F;
  for (float& slew : limits.effort_slew_per_tick) {
    slew = 17.0F;
  }
  EXPECT_TRUE(gate.configure(limits));
  gate.command({}, kIdentity);
  gate.command({}, kIdentity);
  return gate.command({x, 0.0F, 0.0F}, kIdentity).command;
}

}  // namespace tactree::test
