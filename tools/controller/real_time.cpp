#include "real_time.hpp"

#include <fmt/core.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/resource.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <ctime>

namespace tactree::controller {
namespace {

constexpr std::size_t kStackBytes = 256U << 10U;
constexpr std::size_t kPageBytes = 4096;

[[gnu::noinline]] void touch_stack() {
  std::array<std::byte, kStackBytes> stack;
  for (std::size_t i = 0; i < kStackBytes; i += kPageBytes) {
    stack[i] = std::byte{0};
  }
  asm volatile("" : : "r"(stack.data()) : "memory");  // keeps the compiler from removing it
}

std::string no_priority(int priority, int error) {
  return fmt::format(
      "SCHED_FIFO {}: {}: any other program can delay a tick (run as root, or give the service "
      "LimitRTPRIO={} and CAP_SYS_NICE)",
      priority, std::strerror(error), priority + 1);
}

std::string no_lock(int error) {
  return fmt::format(
      "locked memory: {}: a page fault can delay a tick (run as root, or give the service "
      "LimitMEMLOCK=infinity)",
      std::strerror(error));
}

}  // namespace

std::vector<std::string> enter_real_time(const RealTimeSettings& settings) {
  std::vector<std::string> missing;
  if (mlockall(MCL_CURRENT | MCL_FUTURE) != 0) {
    missing.push_back(no_lock(errno));
  }
  touch_stack();
  timespec now{};  // touches the kernel's clock page, which cannot be locked
  (void)clock_gettime(CLOCK_MONOTONIC, &now);
  if (settings.priority > 0) {
    sched_param parameters{};
    parameters.sched_priority = settings.priority;
    if (sched_setscheduler(0, SCHED_FIFO, &parameters) != 0) {
      missing.push_back(no_priority(settings.priority, errno));
    }
  }
  return missing;
}

std::vector<std::string> missing_rights(const RealTimeSettings& settings) {
  std::vector<std::string> missing;
  const int policy = sched_getscheduler(0);
  sched_param before{};
  (void)sched_getparam(0, &before);
  if (settings.priority > 0) {
    sched_param wanted{};
    wanted.sched_priority = settings.priority;
    if (sched_setscheduler(0, SCHED_FIFO, &wanted) != 0) {
      missing.push_back(no_priority(settings.priority, errno));
    }
    (void)sched_setscheduler(0, policy, &before);
  }
  if (mlockall(MCL_CURRENT) != 0) {
    missing.push_back(no_lock(errno));
  }
  (void)munlockall();
  return missing;
}

Disturbances disturbances() {
  rusage usage{};
  (void)getrusage(RUSAGE_THREAD, &usage);
  return {static_cast<std::uint64_t>(usage.ru_minflt), static_cast<std::uint64_t>(usage.ru_majflt),
          allocations_of_this_thread()};
}

}  // namespace tactree::controller
