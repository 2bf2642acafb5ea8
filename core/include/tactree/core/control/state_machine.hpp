#pragma once
// State machine of the controller: one table, state x event -> state. Only kActive has force. An
// event that a state does not allow is a fault. A fault stays latched until its cause has ended,
// then clear-fault and stop were received.
// Interrupt safe: pure functions. Cost: constant.
// Loop and memory annotations: docs/BOUND.md.
// memory: RAM

#include <cstdint>

namespace tactree::core {

enum class State : std::uint8_t {
  kBoot = 0,  ///< not configured
  kNoModel,   ///< configured, no model
  kIdle,      ///< ready, motors off
  kArmed,     ///< enable line on, waiting for the hand: force zero
  kActive,    ///< the only state with force
  kFault,     ///< motors off, latched
};
inline constexpr std::uint32_t kStates = 6;

enum class Event : std::uint8_t {
  kConfigured = 0,  ///< a configuration was accepted
  kModelLoaded,     ///< a model was accepted
  kModelRemoved,
  kArm,      ///< command
  kStop,     ///< command
  kClear,    ///< command clear-fault
  kReady,    ///< armed, enable line on, probe in free space, dead-man control held
  kUnready,  ///< dead-man control released
  kFault,    ///< a fault was detected
  kRecover,  ///< stop, after every fault was cleared
};
inline constexpr std::uint32_t kEvents = 10;

namespace transition_table {

constexpr State kB = State::kBoot;
constexpr State kN = State::kNoModel;
constexpr State kI = State::kIdle;
constexpr State kR = State::kArmed;
constexpr State kA = State::kActive;
constexpr State kF = State::kFault;

/// Rows: states. Columns: events.
inline constexpr State kNext[kStates][kEvents] = {
    // Configured Loaded Removed Arm Stop Clear Ready Unready Fault Recover
    {kN, kF, kB, kF, kB, kB, kF, kB, kF, kB},  // boot
    {kN, kI, kN, kF, kN, kN, kF, kN, kF, kN},  // no-model
    {kI, kI, kN, kR, kI, kI, kF, kI, kF, kI},  // idle
    {kF, kF, kF, kR, kI, kR, kA, kR, kF, kF},  // armed
    {kF, kF, kF, kA, kI, kA, kA, kR, kF, kF},  // active
    {kF, kF, kF, kF, kF, kF, kF, kF, kF, kB},  // fault
};

}  // namespace transition_table

constexpr State next_state(State state, Event event) {
  const auto row = static_cast<std::uint32_t>(state);
  return transition_table::kNext[row][static_cast<std::uint32_t>(event)];  // memory: flash
}

/// "boot", "no-model", ...
[[nodiscard]] const char* name_of(State state);

}  // namespace tactree::core
