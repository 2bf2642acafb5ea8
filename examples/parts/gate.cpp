// The limits of force, slew and effort between your forces and your motors: NaN becomes zero.
#include "tactree/core/safety/safety_gate.hpp"

using namespace tactree::core;

static SafetyGate gate;

bool limit(float force_max_N) { return gate.configure({.force_max_N = force_max_N}); }

/// `effort_per_force`: the transposed Jacobian. Call it in each tick, also while the motors are
/// off.
MotorCommand command(bool active, Vec3 force_N, const Mat3& effort_per_force) {
  return (active ? gate.command(force_N, effort_per_force) : gate.release()).command;
}
