#include "serve_session.hpp"

#include <algorithm>
#include <chrono>
#include <csignal>
#include <thread>

namespace tactree::cli {
namespace {

using Clock = std::chrono::steady_clock;

// A person takes a moment to press the control after "arm"; one that is held at once is as if tied
// down, and does not count.
constexpr double kHandAfterS = 0.08;

// Ticks that may be late and are still made up for.
constexpr int kLateMax = 10;

volatile std::sig_atomic_t ending = 0;

void end(int) { ending = 1; }

/// Where the hand is on its path: on it there is force, else on its way back to the begin.
class HandTime {
 public:
  HandTime(double length_s, double period_s) : length_s_(length_s), period_s_(period_s) {}

  double next(bool active) {
    const bool forth = active && forth_;
    t_s_ = std::clamp(t_s_ + (forth ? period_s_ : -period_s_), 0.0, length_s_);
    if (t_s_ >= length_s_) {
      forth_ = false;
    } else if (t_s_ <= 0.0) {
      forth_ = true;
    }
    return t_s_;
  }

 private:
  double length_s_;
  double period_s_;
  double t_s_ = 0.0;
  bool forth_ = true;
};

class DeadMan {
 public:
  bool is_held(core::State state, double period_s) {
    const bool wanted = state == core::State::kArmed || state == core::State::kActive;
    since_s_ = wanted ? since_s_ + period_s : 0.0;
    return since_s_ > kHandAfterS;
  }

 private:
  double since_s_ = 0.0;
};

}  // namespace

void serve_session(simulation::Simulation& simulation, const ServeSchedule& schedule) {
  std::signal(SIGINT, end);
  std::signal(SIGTERM, end);
  const double period_s = 1.0 / schedule.rate_hz;
  HandTime hand(schedule.path_s, period_s);
  DeadMan dead_man;
  const auto period = std::chrono::duration_cast<Clock::duration>(
      std::chrono::duration<double>(period_s));
  Clock::time_point due = Clock::now();
  double t_s = 0.0;
  while (ending == 0 && (schedule.seconds_max <= 0.0 || t_s < schedule.seconds_max)) {
    const core::State state = simulation.state();
    simulation.board().safety_inputs().hold_dead_man(dead_man.is_held(state, period_s));
    (void)simulation.step_with_hand_at(hand.next(state == core::State::kActive));
    t_s += period_s;
    // A computer that was too slow for a while does not catch up: the session takes longer then.
    due = std::max(due + period, Clock::now() - kLateMax * period);
    if (schedule.wait) {
      schedule.wait(due);
    } else {
      std::this_thread::sleep_until(due);
    }
  }
  simulation.finish();
}

}  // namespace tactree::cli
