#pragma once
// Files that the ticks of a board are recorded to. A recording may last for hours: rows are on the
// way to the disk as soon as append() returns, and memory does not grow with their number.

#include <filesystem>
#include <memory>
#include <span>

#include "tactree/telemetry/tick_table.hpp"

namespace tactree::telemetry {

class TickFile {
 public:
  TickFile() = default;
  TickFile(const TickFile&) = delete;
  TickFile& operator=(const TickFile&) = delete;
  virtual ~TickFile() = default;

  /// Throws UserError if a row cannot be written. The rows of earlier calls are kept; finish()
  /// still works.
  virtual void append(std::span<const Tick> ticks) = 0;
  /// Gives the file its name. Call it once, last. Throws UserError.
  virtual void finish() = 0;
};

/// Throws UserError unless the name ends with .csv or .npz, or is a device or pipe, which receives
/// CSV. Call it before any work.
void check_tick_file(const std::filesystem::path& file);

/// Opens a file by its name, see check_tick_file().
///
/// CSV: a row of column names, then the rows. Without finish(), they are in FILE.incomplete.
/// NPZ: an archive for numpy.load() with an array for each column, and the array state_names, whose
/// elements `state` counts. Until finish(), the rows are in a file without a name, so nothing
/// remains if the program is killed.
///
/// The columns are those of messages with `fields`.
[[nodiscard]] std::unique_ptr<TickFile> open_tick_file(const std::filesystem::path& file,
                                                       std::uint32_t fields = kRecordedFields);

}  // namespace tactree::telemetry
