// Whatever a file of points or of a hand's way holds, it is refused with a reason, or gives finite
// numbers; and so do the texts of --inject.

#include <cmath>

#include "command.hpp"
#include "csv_points.hpp"
#include "memory_file.hpp"
#include "tactree/simulation/hand_path.hpp"
#include "tactree/simulation/injection.hpp"

namespace {

using namespace tactree;

void read_points(const std::string& file) {
  try {
    for (const auto& row : cli::read_csv_rows<3>(file, "x,y,z")) {
      for (const double coordinate : row) {
        fuzz::require(std::isfinite(coordinate), "a coordinate is not finite");
      }
    }
  } catch (const cli::CommandError& error) {
    fuzz::require_reason(error.what(), file);
  }
}

void read_path(const std::string& file) {
  try {
    const simulation::HandPath path = simulation::read_hand_path(file);
    for (const simulation::Waypoint& waypoint : path.waypoints()) {
      fuzz::require(std::isfinite(waypoint.t_s) && waypoint.position_m.allFinite(),
                    "a place that is not finite");
    }
    (void)path.at(path.waypoints().back().t_s);
  } catch (const std::runtime_error& error) {
    fuzz::require_reason(error.what(), file);
  }
}

void parse_fault(std::string_view text) {
  if (text.find('\0') != std::string_view::npos) {
    return;  // no shell can give it
  }
  try {
    const simulation::InjectedFault fault = simulation::parse_injection(text);
    fuzz::require(
        std::isfinite(fault.value) && std::isfinite(fault.from_s) && fault.until_s > fault.from_s,
        "a fault at no time");
  } catch (const std::invalid_argument& error) {
    fuzz::require(std::string_view(error.what()).size() > 10, "a refusal without a reason");
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const fuzz::MemoryFile file(data, size);
  read_points(file.path().string());
  read_path(file.path().string());
  parse_fault({reinterpret_cast<const char*>(data), size});
  return 0;
}
