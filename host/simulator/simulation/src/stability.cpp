#include "tactree/simulation/stability.hpp"

#include <algorithm>
#include <cmath>
#include <deque>

#include "tactree/core/control/passivity.hpp"
#include "tactree/core/device/velocity.hpp"

namespace tactree::simulation {
namespace {

constexpr double kSeconds = 10.0;
constexpr double kBegin_m = 1e-3;

/// A mass with a damper under a constant force, in closed form.
class Tip {
 public:
  Tip(double mass_kg, double damping_Ns_m) : mass_(mass_kg), rate_(damping_Ns_m / mass_kg) {}

  void move(double force_N, double duration_s) {
    const double a = rate_ * duration_s;
    // mean = (1 - exp(-a)) / a and rest = (1 - mean) / a as series, because a is small and the
    // closed forms would cancel.
    double mean = 1.0;
    double rest = 0.5;
    double term = 1.0;
    for (double n = 2.0; n <= 14.0; n += 1.0) {
      term *= -a / n;
      mean += term;
      rest += term / (n + 1.0);
    }
    const double push = force_N / mass_;
    x += v * duration_s * mean + push * duration_s * duration_s * rest;
    v += duration_s * mean * (push - rate_ * v);
  }

  double x = kBegin_m;
  double v = 0.0;

 private:
  double mass_;
  double rate_;
};

/// The controller at a wall on one axis; force() is one tick.
class Wall {
 public:
  Wall(const StabilityCase& c, double stiffness_N_m) : case_(c), stiffness_(stiffness_N_m) {
    const auto period_s = static_cast<float>(1.0 / c.rate_hz);
    const auto step_m = static_cast<float>(c.encoder_step_m);
    velocity_.configure(period_s, {step_m, step_m, step_m},
                        static_cast<float>(std::min(c.velocity_cutoff_hz, 0.5 * c.rate_hz)));
    passivity_.configure(period_s, static_cast<float>(c.passivity_Ns_m),
                         static_cast<float>(c.delay_s));
  }

  double force(double x) {
    const double step = case_.encoder_step_m;
    const double seen = step > 0.0 ? std::floor(x / step) * step : x;
    const core::Vec3 probe = {static_cast<float>(seen), 0.0F, 0.0F};
    const core::Vec3 velocity = velocity_.update(probe);
    double wanted = -stiffness_ * seen - case_.wall_damping_Ns_m * static_cast<double>(velocity.x);
    if (case_.passivity_Ns_m > 0.0) {
      const auto stored = static_cast<float>(0.5 * stiffness_ * seen * seen);
      const core::Vec3 added = passivity_.update(shown_, {probe, velocity, {}}, stored);
      wanted += static_cast<double>(added.x);
    }
    shown_ = {static_cast<float>(wanted), 0.0F, 0.0F};
    return wanted;
  }

 private:
  const StabilityCase& case_;
  double stiffness_;
  core::VelocityEstimator velocity_;
  core::PassivityController passivity_;
  core::Vec3 shown_{};
};

}  // namespace

bool is_stable(const StabilityCase& c, double stiffness_N_m) {
  const double period_s = 1.0 / c.rate_hz;
  const double whole = std::floor(c.delay_s / period_s);
  const double rest_s = c.delay_s - whole * period_s;
  // Delayed forces; the first one acts at the start of a tick.
  std::deque<double> coming(static_cast<std::size_t>(whole) + 1, 0.0);
  Tip tip(c.mass_kg, c.device_damping_Ns_m + c.hand_damping_Ns_m);
  Wall wall(c, stiffness_N_m);
  double last_quarter_m = 0.0;
  const double ticks = std::ceil(kSeconds * c.rate_hz);
  for (double i = 0.0; i < ticks; i += 1.0) {
    coming.push_back(wall.force(tip.x));
    tip.move(coming.front(), rest_s);
    coming.pop_front();
    tip.move(coming.front(), period_s - rest_s);
    if (!(std::abs(tip.x) < 1.0)) {
      return false;  // diverged
    }
    last_quarter_m = i >= 0.75 * ticks ? std::max(last_quarter_m, std::abs(tip.x)) : 0.0;
  }
  return last_quarter_m < kBegin_m;
}

double largest_stable_stiffness(const StabilityCase& c) {
  double low = 1.0;
  double high = 1e6;
  while (high / low > 1.002) {
    const double middle = std::sqrt(low * high);
    (is_stable(c, middle) ? low : high) = middle;
  }
  return std::sqrt(low * high);
}

double predicted_stiffness(const StabilityCase& c) {
  core::Configuration configuration;
  configuration.rate_hz = static_cast<float>(c.rate_hz);
  configuration.delay_s = static_cast<float>(c.delay_s);
  configuration.device_damping_Ns_m = static_cast<float>(c.device_damping_Ns_m);
  configuration.hand_damping_Ns_m = static_cast<float>(c.hand_damping_Ns_m);
  configuration.contact.damping_Ns_m = static_cast<float>(c.wall_damping_Ns_m);
  return static_cast<double>(core::stability_limit(configuration).with_hand_N_m);
}

}  // namespace tactree::simulation
