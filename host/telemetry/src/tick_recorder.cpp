#include "tactree/telemetry/tick_recorder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <vector>

namespace tactree::telemetry {

std::string summary_of(const RecordingCounts& counts) {
  std::string missing = "none missing";
  if (counts.missing != 0U) {
    missing = fmt::format("{} missing in {} gaps", counts.missing, counts.gaps);
  }
  if (counts.omitted != 0U) {
    missing += fmt::format(", {} of them omitted by the board", counts.omitted);
  }
  if (counts.every_ticks > 1U) {
    missing += fmt::format(" (one tick of {})", counts.every_ticks);
  }
  return fmt::format("{} ticks in {:.3f} s, {}", counts.rows,
                     1e-6 * static_cast<double>(counts.time_us), missing);
}

TickRecorder::TickRecorder(const std::filesystem::path& file, const RecordingOptions& options)
    : file_(open_tick_file(file, options.fields)),
      sequence_(options.every_ticks),
      end_us_(1e6 * options.seconds) {
  counts_.every_ticks = options.every_ticks;
}

bool TickRecorder::add(std::span<const core::wire::Telemetry> messages) {
  std::vector<Tick> rows;
  bool goes_on = true;
  for (const core::wire::Telemetry& message : messages) {
    const std::optional<Tick> tick = sequence_.next(message);
    if (!tick) {
      continue;
    }
    if (end_us_ > 0.0 && static_cast<double>(tick->time_us) >= end_us_) {
      goes_on = false;
      break;
    }
    rows.push_back(*tick);
  }
  file_->append(rows);
  for (const Tick& row : rows) {
    count(row);
  }
  return goes_on;
}

void TickRecorder::count(const Tick& row) {
  // At most what is missing: the board may have omitted ticks before the first row.
  const std::uint32_t omitted = row.telemetry.header.dropped;
  counts_.omitted += std::min(omitted - omitted_before_, row.missing_ticks);
  omitted_before_ = omitted;
  ++counts_.rows;
  counts_.missing += row.missing_ticks;
  counts_.gaps += row.missing_ticks == 0U ? 0U : 1U;
  counts_.time_us = row.time_us;
}

}  // namespace tactree::telemetry
