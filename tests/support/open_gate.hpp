#pragma once
// A safety gate that lets any force of at most 8 N through, and its commands.

#include <gtest/gtest.h>

#include "tactree/core/safety/safety_gate.hpp"

namespace tactree::test {

inline constexpr core::Mat3 kIdentity{{{1.0F, 0.0F, 0.0F}, {0.0F, 1.0F, 0.0F}, {0.0F, 0.0F, 1.0F}}};

/// Limits of which only the ramp of two ticks and the force limit act.
inline core::GateLimits roomy() {
  core::GateLimits limits;
  limits.slew_N_per_tick = 16.0F;
  for (std::uint32_t i = 0; i < core::kAxes; ++i) {
    limits.effort_max[i] = 100.0F;
    limits.effort_slew_per_tick[i] = 200.0F;
  }
  limits.ramp_ticks = 2;
  return limits;
}

/// A gate after the end of its ramp.
inline core::SafetyGate ramped(const core::GateLimits& limits = roomy()) {
  core::SafetyGate gate;
  EXPECT_TRUE(gate.configure(limits));
  for (std::uint32_t i = 0; i < limits.ramp_ticks; ++i) {
    gate.command({}, kIdentity);
  }
  return gate;
}

/// A command for motors; their efforts equal the force.
inline core::MotorCommand command_of(core::Vec3 force) {
  return ramped().command(force, kIdentity).command;
}
inline core::MotorCommand command_of(float x) { return command_of({x, 0.0F, 0.0F}); }

}  // namespace tactree::test
