#pragma once
// CLOCK_MONOTONIC in ns.

#include <cstdint>
#include <ctime>

namespace tactree::hal::linux_time {

constexpr std::uint64_t kNsPerSecond = 1'000'000'000;

inline std::uint64_t to_ns(const timespec& time) noexcept {
  return static_cast<std::uint64_t>(time.tv_sec) * kNsPerSecond +
         static_cast<std::uint64_t>(time.tv_nsec);
}

inline std::uint64_t now_ns() noexcept {
  timespec now{};
  (void)clock_gettime(CLOCK_MONOTONIC, &now);
  return to_ns(now);
}

}  // namespace tactree::hal::linux_time
