#pragma once
// The USB device port of a served board, and its cable.

#include <poll.h>

#include <chrono>

namespace tactree::cli {

/// SIGUSR1 pulls the cable, or plugs it in again.
void watch_cable_signal();
/// Did it come since the last call?
[[nodiscard]] bool cable_signal_came();
void tell_cable(bool plugged_in);

/// Until `due`, or something is there to be read from `descriptor` (-1: nothing ever is).
void wait_for(int descriptor, std::chrono::steady_clock::time_point due);

/// Between two ticks: answers the host at once.
template <class Target, class Controller>
void serve_until(std::chrono::steady_clock::time_point due, Target& target,
                 Controller& controller) {
  do {
    wait_for(controller.descriptor(), due);
    if (cable_signal_came()) {
      const bool in = !controller.plugged_in();
      in ? controller.plug_in() : controller.unplug();
      tell_cable(in);
    }
    target.serve();
  } while (std::chrono::steady_clock::now() < due);
}

}  // namespace tactree::cli
