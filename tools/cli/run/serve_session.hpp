#pragma once
// Runs a simulated board for connected programs, in real time or in lock step with them.

#include <chrono>
#include <functional>
#include <vector>

#include "tactree/simulation/simulation.hpp"
#include "tactree/simulation/user.hpp"

namespace tactree::cli {

struct ServeSchedule {
  double rate_hz = 1000.0;
  double path_s = 10.0;                    ///< duration of the hand's path, travelled to and fro
  double seconds_max = 0.0;                ///< 0: until interrupted
  std::vector<simulation::Press> presses;  ///< of the board's button
  /// Called after each tick; returns when the next tick may run, at `due` in real time. If empty,
  /// the session sleeps until `due`.
  std::function<void(std::chrono::steady_clock::time_point due, std::chrono::nanoseconds period)>
      wait;
};

/// Runs until the time is up or interrupted() is true, with a simulation::User at the device.
void serve_session(simulation::Simulation& simulation, const ServeSchedule& schedule);

}  // namespace tactree::cli
