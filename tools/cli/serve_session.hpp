#pragma once
// A simulated board that runs in real time for whoever connects to it.

#include <chrono>
#include <functional>

#include "tactree/simulation/simulation.hpp"

namespace tactree::cli {

struct ServeSchedule {
  double rate_hz = 1000.0;
  double path_s = 10.0;      ///< length of the hand's path: it goes there and back
  double seconds_max = 0.0;  ///< real time; 0: until it is interrupted
  /// Called after each tick, returns when the next is due; none: sleeps.
  std::function<void(std::chrono::steady_clock::time_point due)> wait;
};

/// Ticks in real time until the time is up or a signal ends it (SIGINT, SIGTERM). A person is at
/// the device: holds the dead-man control while the controller is armed, and moves while there is
/// force.
void serve_session(simulation::Simulation& simulation, const ServeSchedule& schedule);

}  // namespace tactree::cli
