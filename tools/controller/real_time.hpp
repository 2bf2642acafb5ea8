#pragma once
// Real-time settings of the kernel for the control loop, and counters of disturbances.

#include <cstdint>
#include <string>
#include <vector>

#include "controller_file.hpp"

namespace tactree::controller {

/// Sets the priority of the calling thread, locks the memory of the process, and touches the
/// thread's stack. Returns one sentence with a hint for each step that failed.
[[nodiscard]] std::vector<std::string> enter_real_time(const RealTimeSettings& settings);

/// What enter_real_time() would return. Has no lasting effect.
[[nodiscard]] std::vector<std::string> missing_rights(const RealTimeSettings& settings);

/// Events in the calling thread that disturb a tick.
struct Disturbances {
  std::uint64_t minor_faults = 0;
  std::uint64_t major_faults = 0;
  std::uint64_t allocations = 0;
};
[[nodiscard]] Disturbances disturbances();

/// Number of calls of malloc, calloc, realloc and aligned_alloc in the calling thread, also from
/// libraries; 0 if they are not counted (a build with AddressSanitizer or without glibc).
[[nodiscard]] std::uint64_t allocations_of_this_thread();

}  // namespace tactree::controller
