#pragma once
// The USB device port of a served board, and its cable.

#include <poll.h>

#include <chrono>

namespace tactree::cli {

/// Handles SIGUSR1, which requests to unplug the cable or to plug it in again.
void watch_cable_signal();
/// True if the signal arrived since the last call.
[[nodiscard]] bool cable_signal_came();
void tell_cable(bool plugged_in);

/// Waits until `due`, or until `descriptor` is readable; -1: no descriptor.
void wait_for(int descriptor, std::chrono::steady_clock::time_point due);

/// Handles requests of the host between two ticks, without delay.
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
