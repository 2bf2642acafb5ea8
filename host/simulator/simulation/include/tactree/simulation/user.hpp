#pragma once
// A simulated user at the device: moves it, holds the dead-man control and presses the button of
// the board.

#include <string_view>
#include <vector>

#include "tactree/core/control/state_machine.hpp"
#include "tactree/simulation/simulation.hpp"

namespace tactree::simulation {

/// The button is pressed in the ticks with from_s <= time < until_s.
struct Press {
  double from_s = 0.0;
  double until_s = 0.0;
};

/// Parses FROM..TO, times in seconds: "0.5s..1.7s". Throws std::invalid_argument with `text` and
/// the cause.
[[nodiscard]] Press parse_press(std::string_view text);

/// Acts by the state of the controller. The user holds the dead-man control while the controller is
/// armed or active, and moves along the path, to and fro, while it is active; otherwise back to the
/// start of the path. Not thread safe.
class User {
 public:
  /// `path_s`: duration of the path of the hand. The times of the presses are those of the samples.
  User(double rate_hz, double path_s, std::vector<Press> presses = {});

  /// Executes one tick of the simulation.
  Sample step(Simulation& simulation);

 private:
  [[nodiscard]] bool holds_dead_man(core::State state);
  [[nodiscard]] double next_path_time(bool active);

  double period_s_;
  double path_s_;
  std::vector<Press> presses_;
  double armed_for_s_ = 0.0;
  double path_t_s_ = 0.0;
  bool forth_ = true;
};

}  // namespace tactree::simulation
