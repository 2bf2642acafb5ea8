#include "run/usb_port.hpp"

#include <fmt/core.h>

#include <csignal>
#include <cstdio>

namespace tactree::cli {
namespace {

volatile std::sig_atomic_t signal_came = 0;

void note_signal(int) { signal_came = 1; }

}  // namespace

void watch_cable_signal() {
  struct sigaction action {};
  action.sa_handler = note_signal;  // without SA_RESTART, so that the signal ends a wait
  sigaction(SIGUSR1, &action, nullptr);
}

bool cable_signal_came() {
  const bool came = signal_came != 0;
  signal_came = 0;
  return came;
}

void tell_cable(bool plugged_in) {
  fmt::print("{}\n", plugged_in ? "plugged in" : "unplugged");
  std::fflush(stdout);
}

void wait_for(int descriptor, std::chrono::steady_clock::time_point due) {
  const auto left =
      std::chrono::duration_cast<std::chrono::nanoseconds>(due - std::chrono::steady_clock::now());
  if (left.count() <= 0) {
    return;
  }
  pollfd socket{descriptor, POLLIN, 0};
  const timespec time{left.count() / 1'000'000'000, left.count() % 1'000'000'000};
  (void)ppoll(&socket, descriptor >= 0 ? 1 : 0, &time, nullptr);
}

}  // namespace tactree::cli
