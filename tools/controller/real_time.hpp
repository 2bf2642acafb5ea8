#pragma once
// What a loop needs of the kernel to be in time, and proof that it got it.

#include <cstdint>
#include <string>
#include <vector>

#include "controller_file.hpp"

namespace tactree::controller {

/// Of the calling thread, from now on: priority, memory that stays where it is, a stack that has
/// been touched. Returns what it could not get, one sentence each with its remedy.
[[nodiscard]] std::vector<std::string> enter_real_time(const RealTimeSettings& settings);

/// What enter_real_time() could not get, were it called. Changes nothing.
[[nodiscard]] std::vector<std::string> missing_rights(const RealTimeSettings& settings);

/// What disturbs a tick, of the calling thread.
struct Disturbances {
  std::uint64_t minor_faults = 0;
  std::uint64_t major_faults = 0;
  std::uint64_t allocations = 0;
};
[[nodiscard]] Disturbances disturbances();

/// Calls of malloc, calloc, realloc and aligned_alloc of the calling thread, by whomever; 0 where
/// they are not counted (a build with sanitizers).
[[nodiscard]] std::uint64_t allocations_of_this_thread();

}  // namespace tactree::controller
