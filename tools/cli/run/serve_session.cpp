#include "run/serve_session.hpp"

#include <algorithm>
#include <chrono>
#include <thread>

#include "interruption.hpp"

namespace tactree::cli {
namespace {

using Clock = std::chrono::steady_clock;

// The simulated user presses the dead-man control with a delay after "arm", because the controller
// ignores a control that was held before.
constexpr double kHandAfterS = 0.08;

/// Time of the hand on its path: to and fro while the controller is active, otherwise back to the
/// start.
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

/// Ticks in real time. If the computer is late, simulated time is delayed instead of caught up: a
/// burst of missed ticks would leave programs no time to answer, and the link would time out.
class Pacer {
 public:
  explicit Pacer(double period_s)
      : period_(
            std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(period_s))) {}

  [[nodiscard]] Clock::duration period() const { return period_; }
  /// Time of the next tick.
  Clock::time_point next() {
    next_ = std::max(next_ + period_, Clock::now() - kMaxLate);
    return next_;
  }

 private:
  static constexpr std::chrono::milliseconds kMaxLate{2};
  Clock::duration period_;
  Clock::time_point next_ = Clock::now();
};

}  // namespace

void serve_session(simulation::Simulation& simulation, const ServeSchedule& schedule) {
  watch_interruption();
  const double period_s = 1.0 / schedule.rate_hz;
  HandTime hand(schedule.path_s, period_s);
  DeadMan dead_man;
  Pacer pacer(period_s);
  double t_s = 0.0;
  while (!interrupted() && (schedule.seconds_max <= 0.0 || t_s < schedule.seconds_max)) {
    const core::State state = simulation.state();
    simulation.board().safety_inputs().hold_dead_man(dead_man.is_held(state, period_s));
    (void)simulation.step_with_hand_at(hand.next(state == core::State::kActive));
    t_s += period_s;
    const Clock::time_point due = pacer.next();
    if (schedule.wait) {
      schedule.wait(due, pacer.period());
    } else {
      std::this_thread::sleep_until(due);
    }
  }
  simulation.finish();
}

}  // namespace tactree::cli
