#pragma once
// How many instructions does each of many calls take? Steps a copy of the process one instruction
// at a time, so it needs neither performance counters nor an emulator. Linux on x86-64.

#include <sys/ptrace.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <functional>
#include <vector>

namespace tactree::bench {

namespace detail {

inline void marker() { asm volatile("int3"); }

/// Runs on to the next marker; false when the process has ended instead.
inline bool run_to_marker(pid_t child) {
  int status = 0;
  ptrace(PTRACE_CONT, child, nullptr, nullptr);
  return waitpid(child, &status, 0) == child && WIFSTOPPED(status) && WSTOPSIG(status) == SIGTRAP;
}

/// Instructions up to the next marker, or 0 when the process ends before it.
inline std::uint64_t step_to_marker(pid_t child) {
  for (std::uint64_t steps = 0;; ++steps) {
    int status = 0;
    siginfo_t signal{};
    ptrace(PTRACE_SINGLESTEP, child, nullptr, nullptr);
    if (waitpid(child, &status, 0) != child || !WIFSTOPPED(status) ||
        ptrace(PTRACE_GETSIGINFO, child, nullptr, &signal) != 0) {
      return 0;
    }
    if (signal.si_code == SI_KERNEL) {  // int3; a step gives TRAP_TRACE
      return steps;
    }
  }
}

}  // namespace detail

/// Instructions of call(0), ..., call(calls - 1), less those of an empty call. Empty if a process
/// may not step another one here, or if a count is wrong: the copy was stopped or killed, or a call
/// seems to take no instruction.
inline std::vector<std::uint64_t> count_instructions(std::size_t calls,
                                                     const std::function<void(std::size_t)>& call) {
  const pid_t child = fork();
  if (child == 0) {
    if (ptrace(PTRACE_TRACEME, 0, nullptr, nullptr) != 0) {
      _exit(1);
    }
    const std::function<void(std::size_t)> nothing = [](std::size_t) {};
    for (std::size_t i = 0; i <= calls; ++i) {
      const auto& measured = i == 0 ? nothing : call;
      detail::marker();
      measured(i == 0 ? 0 : i - 1);
      detail::marker();
    }
    _exit(0);
  }
  std::vector<std::uint64_t> counts;
  std::uint64_t empty_call = 0;
  for (std::size_t i = 0; i <= calls && detail::run_to_marker(child); ++i) {
    const std::uint64_t steps = detail::step_to_marker(child);
    if (i == 0) {
      empty_call = steps;
    } else if (steps > empty_call) {
      counts.push_back(steps - empty_call);
    } else {
      break;
    }
  }
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);
  return counts.size() == calls ? counts : std::vector<std::uint64_t>{};
}

}  // namespace tactree::bench
