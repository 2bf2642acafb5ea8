#pragma once
// When there may be force: one table, state x event -> state. What the table does not allow is a
// fault; a fault latches until its cause is gone, clear-fault was given and then stop.

#include <cstdint>

namespace tactree::core {

enum class State : std::uint8_t {
  kBoot = 0,  ///< not configured
  kNoModel,   ///< configured, nothing to touch
  kIdle,      ///< ready, motors off
  kArmed,     ///< enable line on, waiting for the hand: force still zero
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
  kReady,    ///< armed, enable line up, probe in free space, and the hand confirms
  kUnready,  ///< the dead-man control was let go
  kFault,    ///< something is wrong
  kRecover,  ///< stop, with every fault cleared
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
