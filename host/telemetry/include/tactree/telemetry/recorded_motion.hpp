#pragma once
// How a probe moved, from the recording of a board or a trace of `tactree simulate`.

#include <array>
#include <filesystem>
#include <vector>

namespace tactree::telemetry {

struct RecordedTick {
  double t_s = 0.0;                    ///< since the first tick
  std::array<double, 3> probe_m = {};  ///< frame of the recording
  bool in_contact = false;             ///< false if the file does not say
};

/// True for an .npz, and for a file whose first line names the columns of a probe. A pipe is not
/// read and not a recording.
[[nodiscard]] bool is_recording(const std::filesystem::path& file);

/// The ticks in the state `active`, or all if the file has no states; at least one, in ascending
/// time. They begin with the first one without contact, where a hand can begin, unless all have
/// contact. Missing ticks are not replaced. Throws support::UserError or support::CsvError with the
/// place and the remedy.
[[nodiscard]] std::vector<RecordedTick> read_recorded_motion(const std::filesystem::path& file);

}  // namespace tactree::telemetry
