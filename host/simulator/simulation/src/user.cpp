#include "tactree/simulation/user.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>

#include "number_text.hpp"

namespace tactree::simulation {
namespace {

// The user presses the dead-man control with a delay after "arm", because the controller ignores a
// control that was held before.
constexpr double kHandAfterS = 0.08;

[[noreturn]] void refuse_press(std::string_view text, const std::string& what) {
  throw std::invalid_argument(
      fmt::format("'{}': {} (FROM..TO in seconds, e.g. 0.5s..1.7s)", text, what));
}

double seconds_of(std::string_view text, std::string_view time) {
  const double value = parse_seconds(time).value_or(-1.0);
  if (!(value >= 0.0 && value <= 1e9)) {
    refuse_press(text, fmt::format("'{}' is not a time from 0 upwards", time));
  }
  return value;
}

}  // namespace

Press parse_press(std::string_view text) {
  const std::size_t between = text.find("..");
  if (between == std::string_view::npos) {
    refuse_press(text, "the end of the press is missing");
  }
  const Press press{seconds_of(text, text.substr(0, between)),
                    seconds_of(text, text.substr(between + 2))};
  if (!(press.until_s > press.from_s)) {
    refuse_press(text, "the end is not after the start");
  }
  return press;
}

User::User(double rate_hz, double path_s, std::vector<Press> presses)
    : period_s_(1.0 / rate_hz), path_s_(path_s), presses_(std::move(presses)) {}

Sample User::step(Simulation& simulation) {
  const core::State state = simulation.state();
  const double t_s = simulation.time_s();
  simulation.board().safety_inputs().hold_dead_man(holds_dead_man(state));
  simulation.board().panel().press(std::any_of(
      presses_.begin(), presses_.end(),
      [t_s](const Press& press) { return t_s >= press.from_s && t_s < press.until_s; }));
  return simulation.step_with_hand_at(next_path_time(state == core::State::kActive));
}

bool User::holds_dead_man(core::State state) {
  const bool wanted = state == core::State::kArmed || state == core::State::kActive;
  armed_for_s_ = wanted ? armed_for_s_ + period_s_ : 0.0;
  return armed_for_s_ > kHandAfterS;
}

double User::next_path_time(bool active) {
  const bool forth = active && forth_;
  path_t_s_ = std::clamp(path_t_s_ + (forth ? period_s_ : -period_s_), 0.0, path_s_);
  if (path_t_s_ >= path_s_) {
    forth_ = false;
  } else if (path_t_s_ <= 0.0) {
    forth_ = true;
  }
  return path_t_s_;
}

}  // namespace tactree::simulation
