// Reads arbitrary bytes as a file of points, as a hand path and as a fault of --inject: each is
// refused with a reason or gives finite numbers.

#include <cmath>

#include "memory_file.hpp"
#include "scan/read_points.hpp"
#include "tactree/setup/path_file.hpp"
#include "tactree/simulation/injection.hpp"
#include "tactree/support/csv.hpp"

namespace {

using namespace tactree;

void examine_points(const std::string& file) {
  try {
    for (const auto& row : cli::read_points(file)) {
      for (const double coordinate : row) {
        fuzz::require(std::isfinite(coordinate), "a coordinate is not finite");
      }
    }
  } catch (const support::CsvError& error) {
    fuzz::require_reason(error.what(), file);
  }
}

void examine_path(const std::string& file) {
  try {
    const simulation::HandPath path = setup::read_path_file(file);
    for (const simulation::Waypoint& waypoint : path.waypoints()) {
      fuzz::require(std::isfinite(waypoint.t_s) && waypoint.position_m.allFinite(),
                    "a waypoint is not finite");
    }
    (void)path.at(path.waypoints().back().t_s);
  } catch (const std::runtime_error& error) {
    fuzz::require_reason(error.what(), file);
  }
}

void examine_fault(std::string_view text) {
  if (text.find('\0') != std::string_view::npos) {
    return;  // no argument holds a zero byte
  }
  try {
    const simulation::InjectedFault fault = simulation::parse_injection(text);
    fuzz::require(
        std::isfinite(fault.value) && std::isfinite(fault.from_s) && fault.until_s > fault.from_s,
        "the fault has no duration");
  } catch (const std::invalid_argument& error) {
    fuzz::require(std::string_view(error.what()).size() > 10, "a refusal without a reason");
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const fuzz::MemoryFile file(data, size);
  examine_points(file.path().string());
  examine_path(file.path().string());
  examine_fault({reinterpret_cast<const char*>(data), size});
  return 0;
}
