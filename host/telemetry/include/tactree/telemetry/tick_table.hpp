#pragma once
// The telemetry of a board as the rows of a table: one row for each received tick.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "tactree/core/link/wire/telemetry.hpp"

namespace tactree::telemetry {

/// The fields of a recording: all but the reactions of the bodies.
inline constexpr std::uint32_t kRecordedFields =
    core::wire::kAllTelemetry & ~static_cast<std::uint32_t>(core::wire::TelemetryField::kReactions);

/// Those that exist in version 1.`minor` of the protocol.
[[nodiscard]] constexpr std::uint32_t recorded_fields(std::uint8_t minor) {
  return kRecordedFields & core::wire::telemetry_fields_of(minor);
}

/// Bytes on the wire of a message with these fields, including header, checksum and framing.
[[nodiscard]] std::size_t frame_bytes(std::uint32_t fields = kRecordedFields);

struct Tick {
  std::uint64_t time_us = 0;        ///< board time since the first tick; does not wrap
  std::uint32_t missing_ticks = 0;  ///< messages missing between the previous tick and this one
  core::wire::Telemetry telemetry{};
};

/// Orders the messages of one subscription.
class TickSequence {
 public:
  /// `every_ticks`: decimation of the subscription; the ticks between two messages are not missing.
  explicit TickSequence(std::uint32_t every_ticks = 1) : every_ticks_(every_ticks) {}

  /// Returns nothing if the message is not newer than the previous one.
  [[nodiscard]] std::optional<Tick> next(const core::wire::Telemetry& telemetry);

 private:
  std::uint32_t every_ticks_;
  bool begun_ = false;
  std::uint64_t time_us_ = 0;
  core::wire::TelemetryHeader last_{};
};

enum class ColumnType : std::uint8_t { kFloat64, kFloat32, kUint32, kInt32, kUint8 };

[[nodiscard]] std::size_t bytes_of(ColumnType type);

struct Column {
  std::string name;  ///< with the unit
  ColumnType type = ColumnType::kFloat32;
  std::vector<std::string> words;  ///< if not empty, the values are indices of these words
};

/// The columns of a recording. Names that a trace of `tactree simulate` also has mean the same.
[[nodiscard]] const std::vector<Column>& columns();

/// The columns of a recording of messages with these fields: without gravity_force, added_force and
/// motor_force if kParts, which boards of protocol 1.0 do not send, is not among them.
[[nodiscard]] std::vector<Column> columns_of(std::uint32_t fields);

/// Writes the values of a tick, in the order of columns_of(fields). A double holds each of them
/// exactly. The forces of kParts are NaN if the message does not contain them.
void values_of(const Tick& tick, std::vector<double>& values,
               std::uint32_t fields = kRecordedFields);

}  // namespace tactree::telemetry
