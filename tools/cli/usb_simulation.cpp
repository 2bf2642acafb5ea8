#include "usb_simulation.hpp"

#include <fmt/core.h>
#include <poll.h>

#include <chrono>
#include <csignal>
#include <cstdio>

namespace tactree::cli {
namespace {

using Clock = std::chrono::steady_clock;

volatile std::sig_atomic_t end_asked = 0;
volatile std::sig_atomic_t cable_asked = 0;

void note_signal(int number) {
  if (number == SIGUSR1) {
    cable_asked = 1;
  } else {
    end_asked = 1;
  }
}

void take_signals() {
  end_asked = 0;
  cable_asked = 0;
  struct sigaction action {};
  action.sa_handler = note_signal;  // without SA_RESTART: a wait ends
  for (const int number : {SIGINT, SIGTERM, SIGUSR1}) {
    sigaction(number, &action, nullptr);
  }
}

void move_cable(served::UsbBoard& board) {
  if (cable_asked == 0) {
    return;
  }
  cable_asked = 0;
  if (board.controller().plugged_in()) {
    board.controller().unplug();
    fmt::print("unplugged\n");
  } else {
    board.controller().plug_in();
    fmt::print("plugged in\n");
  }
  std::fflush(stdout);
}

/// Until it is time, or the host sends something.
void wait_for_host(served::UsbBoard& board, Clock::time_point until) {
  const auto left = std::chrono::duration_cast<std::chrono::nanoseconds>(until - Clock::now());
  if (left.count() <= 0) {
    return;
  }
  pollfd socket{board.controller().descriptor(), POLLIN, 0};
  const timespec time{left.count() / 1'000'000'000, left.count() % 1'000'000'000};
  (void)ppoll(&socket, socket.fd >= 0 ? 1 : 0, &time, nullptr);
}

}  // namespace

core::usb::Identity usb_identity(const UsbSimulationOptions& options) {
  core::usb::Identity identity;
  identity.name = "Simulated controller";
  identity.serial = {0, 0, options.serial};
  return identity;
}

hal::BoardIdentity board_identity(const UsbSimulationOptions& options) {
  hal::BoardIdentity identity;
  identity.board = "host";
  identity.firmware = TACTREE_VERSION;
  identity.serial[2] = options.serial;
  return identity;
}

void run_on_usb(served::UsbBoard& board, simulation::Simulation& simulation,
                const core::Configuration& configuration, const UsbSimulationOptions& options) {
  take_signals();
  board.controller().plug_in();
  fmt::print("plugged in\n");
  std::fflush(stdout);
  const auto period = std::chrono::duration_cast<Clock::duration>(
      std::chrono::duration<double>(1.0 / static_cast<double>(configuration.rate_hz)));
  const Clock::time_point begin = Clock::now();
  Clock::time_point next = begin;
  while (end_asked == 0 &&
         (!options.seconds || Clock::now() - begin < std::chrono::duration<double>(*options.seconds))) {
    const simulation::Sample sample = simulation.step();
    board.serve(sample.status);
    // A computer that was too busy for a while does not catch up: the session is slower then.
    next = std::max(next + period, Clock::now() - 10 * period);
    do {
      wait_for_host(board, next);
      board.serve(sample.status);
      move_cable(board);
    } while (end_asked == 0 && Clock::now() < next);
  }
  board.controller().unplug();
}

}  // namespace tactree::cli
