#pragma once
// Codes of faults and limits. docs/faults/ has a page for each.
// Interrupt safe: pure functions.

#include <cstdint>

namespace tactree::core {

enum class Fault : std::uint8_t {
  kNone = 0,
  kEmergencyStop = 1,     ///< the emergency stop input is open
  kEncoderInvalid = 2,    ///< an invalid or lost count, or an impossible pose
  kEncoderJump = 3,       ///< the probe moved faster than speed_max_m_s
  kNotFinite = 4,         ///< a force or effort is NaN or infinite
  kDeadlineMissed = 5,    ///< two overruns within 100 ticks
  kLinkLost = 6,          ///< no message for longer than link_timeout_s while the link is required
  kEnableMismatch = 7,    ///< the enable line's read-back contradicts the command
  kUnexpectedEvent = 8,   ///< a command that the state does not allow
  kMotorFault = 9,        ///< the motor bank reports a failure
  kModelIncomplete = 10,  ///< the model exceeds its declared limits or has an invalid index
  kEncoderStuck = 11,     ///< the force that moves an axis changes, its count does not
  kSupply = 12,           ///< the amplifiers' supply is outside supply_min_V .. supply_max_V
};
inline constexpr std::uint32_t kFaultCodes = 13;

/// A set of faults: bit n is the fault with code n.
using FaultMask = std::uint32_t;

constexpr FaultMask fault_bit(Fault fault) {
  return fault == Fault::kNone ? 0U : 1U << static_cast<std::uint32_t>(fault);
}

constexpr bool has_fault(FaultMask mask, Fault fault) { return (mask & fault_bit(fault)) != 0U; }

/// Name as in docs/faults/: "emergency-stop", ...; "unknown" for an invalid code. Cost: constant.
[[nodiscard]] const char* name_of(Fault fault);

/// Limits that reduce the force in a tick without a fault.
enum class Limit : std::uint32_t {
  kForce = 1U << 0,      ///< the force exceeded force_max_N
  kSlew = 1U << 1,       ///< the force changed faster than slew_N_s
  kRamp = 1U << 2,       ///< the force ramps up after activation
  kAxis = 1U << 3,       ///< an axis reached its effort_max or effort_slew_s
  kBoundary = 1U << 4,   ///< surface boundary, or body removed: the force fades
  kWaiting = 1U << 5,    ///< no force: probe inside a body, or armed and confirmed but not ready
  kWorkspace = 1U << 6,  ///< near a joint limit or singular pose: the force fades
  kNotHomed = 1U << 7,   ///< no force: the joint positions are unknown (homing.hpp)
  kBodies = 1U << 8,     ///< more than kMaxReachableBodies bodies within reach: some not rendered
  kThermal = 1U << 9,    ///< a motor is warm: its peak effort is reduced
};
using LimitMask = std::uint32_t;
inline constexpr std::uint32_t kLimits = 10;

constexpr LimitMask limit_bit(Limit limit) { return static_cast<LimitMask>(limit); }

/// Name as in docs/faults/, without "limit-"; "unknown" for an invalid value. Cost: constant.
[[nodiscard]] const char* name_of(Limit limit);

}  // namespace tactree::core
