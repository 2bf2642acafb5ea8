// Reads arbitrary bytes as a recording, CSV or .npz: each is refused with a reason, or gives finite
// positions at ascending times, and a hand can repeat them.

#include <cmath>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include "memory_file.hpp"
#include "tactree/simulation/repeated_path.hpp"
#include "tactree/viewer/trace_playback.hpp"

namespace {

using namespace tactree;

void repeat(const std::vector<simulation::Sample>& samples) {
  try {
    const simulation::HandPath path = simulation::repeated_path(samples);
    for (const simulation::Waypoint& waypoint : path.waypoints()) {
      fuzz::require(std::isfinite(waypoint.t_s) && waypoint.position_m.allFinite(),
                    "a waypoint is not finite");
    }
  } catch (const std::invalid_argument&) {  // no tick is active
  }
}

void examine(const std::filesystem::path& file) {
  try {
    const std::vector<simulation::Sample> samples = viewer::read_trace(file);
    fuzz::require(!samples.empty(), "a recording without ticks");
    for (std::size_t i = 0; i < samples.size(); ++i) {
      fuzz::require(std::isfinite(samples[i].t_s), "a time is not finite");
      fuzz::require(i == 0 || samples[i].t_s > samples[i - 1].t_s, "the time does not ascend");
      fuzz::require(
          core::is_finite(samples[i].status.probe) && core::is_finite(samples[i].status.force),
          "a position or force is not finite");
    }
    repeat(samples);
  } catch (const std::runtime_error& error) {
    fuzz::require_reason(error.what(), file.string());
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const fuzz::Folder folder;
  const fuzz::MemoryFile file(data, size);
  for (const char* const name : {"trace.csv", "trace.npz"}) {  // the name chooses the format
    const std::filesystem::path link = folder.path() / name;
    std::filesystem::remove(link);
    std::filesystem::create_symlink(file.path(), link);
    examine(link);
  }
  return 0;
}
