#pragma once
// The telemetry message: encoder and decoder. A message is a TelemetryHeader and the fields that
// are set in its `fields`, in the order of TelemetryField, without gaps. Interrupt safe: no shared
// state.

#include <cstddef>
#include <cstdint>
#include <span>

#include "tactree/core/control/controller.hpp"
#include "tactree/core/link/wire/messages.hpp"

namespace tactree::core::wire {

/// All fields of a telemetry message, in memory in the order and layout of the wire. Positions are
/// in the scene's frame. decode_telemetry() does not change a field that was not sent: pass a
/// default Telemetry to get the values given here.
struct Telemetry {
  TelemetryHeader header{};
  std::uint32_t state = 0;   ///< State
  std::uint32_t faults = 0;  ///< FaultMask
  std::uint32_t limits = 0;  ///< LimitMask
  float probe_m[3] = {};
  float velocity_m_s[3] = {};
  float force_N[3] = {};  ///< after the safety gate
  float proxy_m[3] = {};
  float normal[3] = {};
  float penetration_m = 0.0F;        ///< 0: no contact
  std::uint32_t body = 0xFFFFFFFFU;  ///< in contact; kNoBody: none
  float strength = 0.0F;             ///< scale factor of the force; below 1 at a boundary
  float wanted_N[3] = {};            ///< before the safety gate
  std::uint32_t overruns = 0;        ///< since the start of the board
  float load = 0.0F;                 ///< duration of the last tick / period
  struct Reaction {
    std::uint32_t body = 0xFFFFFFFFU;
    float force_N[3] = {};
    float torque_Nm[3] = {};
  } reactions[2]{};
  float gravity_N[3] = {};  ///< at the probe, of the gravity compensation
  float added_N[3] = {};    ///< of the application; part of force_N
  float motors_N[3] = {};   ///< at the probe, of everything that the motors are told
};

/// All fields of TelemetryField.
inline constexpr std::uint32_t kAllTelemetry = (1U << kTelemetryFields) - 1U;
/// Bytes of a message with all fields.
inline constexpr std::uint32_t kMaxTelemetry = 212;
static_assert(kMaxTelemetry == sizeof(Telemetry) && kMaxTelemetry <= kMaxPayload);

/// Converts all fields of a tick's status. Cost: constant.
[[nodiscard]] Telemetry to_telemetry(const TelemetryHeader& header, const Status& status);

/// Writes the header and the fields that are set in `telemetry.header.fields`. Returns the length.
/// Bits beyond kAllTelemetry are ignored. Cost: at most kMaxTelemetry bytes copied.
[[nodiscard]] std::size_t encode_telemetry(const Telemetry& telemetry,
                                           std::span<std::byte, kMaxTelemetry> out);

/// Returns false if the payload is shorter than its fields. Bytes after them are ignored.
[[nodiscard]] bool decode_telemetry(std::span<const std::byte> payload, Telemetry& telemetry);

}  // namespace tactree::core::wire
