#pragma once
// The readings of a tick: sensors, safety inputs and command. Interrupt safety: plain data.

#include <cstdint>

#include "tactree/core/device/homing.hpp"

namespace tactree::core {

/// At most one command a tick.
enum class Command : std::uint8_t {
  kNone = 0,
  kArm,
  kStop,
  kClearFault,
  kHome,  ///< the device is in its home pose; for HomingMethod::kGivenPose, motors off
};

/// Inputs of a tick as plain data, with the same layout on every processor.
struct Readings {
  EncoderReading encoders{};
  bool emergency_stop = true;     ///< true: pressed, or its wire is open
  bool dead_man = false;          ///< true: held
  bool enable_read_back = false;  ///< true: the amplifiers have power
  bool motors_ok = false;         ///< false: the motor bank reports a failure
  bool link_alive = false;        ///< a valid message arrived since the last tick
  /// Flash is being written, which may stall the chip. With the motors off, missed deadlines are
  /// then neither a fault nor counted.
  bool storage_busy = false;
  /// If link_alive: upper bound of the message's age at arrival. The link timeout counts from the
  /// time of sending, not of arrival.
  std::uint16_t link_age_ticks = 0;
  std::uint32_t overruns = 0;  ///< deadlines missed since the last tick
  float load = 0.0F;           ///< duration of the last tick / period
  float supply_V = 0.0F;       ///< of the amplifiers; valid if Configuration::supply_monitored
  Command command = Command::kNone;
};

}  // namespace tactree::core
