#include "run/serve_session.hpp"

#include <algorithm>
#include <chrono>
#include <thread>

#include "interruption.hpp"

namespace tactree::cli {
namespace {

using Clock = std::chrono::steady_clock;

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
  const double period_s = 1.0 / schedule.rate_hz;
  simulation::User user(schedule.rate_hz, schedule.path_s, schedule.presses);
  Pacer pacer(period_s);
  double t_s = 0.0;
  while (!interrupted() && (schedule.seconds_max <= 0.0 || t_s < schedule.seconds_max)) {
    (void)user.step(simulation);
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
