#pragma once
// Records the telemetry of one subscription into a file, and counts what is missing:
//
//   telemetry::TickRecorder recorder("session.csv", {.seconds = 60.0});
//   board.subscribe({telemetry::kRecordedFields, 1});
//   while (recorder.add(board.take_stream())) { ... }
//   recorder.finish();

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>

#include "tactree/telemetry/tick_file.hpp"
#include "tactree/telemetry/tick_table.hpp"

namespace tactree::telemetry {

/// Messages that a program which records lets wait while the disk is slow (BoardOptions): 16 s at
/// 4 kHz, about 14 MB.
inline constexpr std::size_t kStreamCapacity = 65536;

struct RecordingOptions {
  std::uint32_t fields = kRecordedFields;  ///< of the messages
  std::uint32_t every_ticks = 1;           ///< decimation of the subscription
  double seconds = 0.0;                    ///< board time after which the recording ends; 0: never
};

struct RecordingCounts {
  std::uint64_t rows = 0;
  std::uint64_t missing = 0;      ///< messages that are missing between the rows
  std::uint64_t gaps = 0;         ///< number of positions at which they are missing
  std::uint64_t omitted = 0;      ///< of the missing ones, those that the board had no room to send
  std::uint64_t time_us = 0;      ///< board time from the first row to the last one
  std::uint32_t every_ticks = 1;  ///< decimation
};

/// For example "1500 ticks in 1.499 s, none missing", or "..., 12 missing in 3 gaps, 9 of them
/// omitted by the board (one tick of 10)".
[[nodiscard]] std::string summary_of(const RecordingCounts& counts);

class TickRecorder {
 public:
  /// Opens the file, see open_tick_file(). Throws UserError.
  TickRecorder(const std::filesystem::path& file, const RecordingOptions& options);

  /// Appends a row for each message that is newer than the previous one. Returns false once the
  /// duration is over. Throws UserError if the file cannot be extended; it then keeps its rows, and
  /// finish() still works.
  [[nodiscard]] bool add(std::span<const core::wire::Telemetry> messages);
  /// Completes the file. Call it once, last. Throws UserError.
  void finish() { file_->finish(); }

  /// Of the rows in the file.
  [[nodiscard]] const RecordingCounts& counts() const { return counts_; }

 private:
  void count(const Tick& row);

  std::unique_ptr<TickFile> file_;
  TickSequence sequence_;
  double end_us_;  // 0: no end
  RecordingCounts counts_;
  std::uint32_t omitted_before_ = 0;  // counter of the board at the last row
};

}  // namespace tactree::telemetry
