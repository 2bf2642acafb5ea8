#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "errors.hpp"
#include "measurements.hpp"
#include "tactree/core/contact/scene.hpp"
#include "tactree/evaluation/shapes.hpp"
#include "tactree/plant/plant.hpp"
#include "tactree/simulation/simulation.hpp"
#include "tactree/simulation/stability.hpp"
#include "touch.hpp"

namespace tactree::evaluation {
namespace {

using Eigen::Vector3d;

constexpr double kCoarse = 2.5e-3;      // m, point spacing that paper mode needs for 1 mm of depth
constexpr double kEncoderStep = 20e-6;  // m
constexpr double kSpeed = 0.01;         // m/s, of the hand
constexpr double kPress = 1.0;          // N
constexpr double kCorner = 20.0;        // Hz; lower frequencies are motion, not vibration

core::RenderMode render_mode(Mode mode) {
  return mode == kPaper ? core::RenderMode::kPaper : core::RenderMode::kSurface;
}

// ---- vibration

/// Second-order Butterworth high-pass, by the bilinear transform.
class HighPass {
 public:
  HighPass(double corner_hz, double rate_hz) {
    const double k = std::tan(std::numbers::pi * corner_hz / rate_hz);
    const double norm = 1.0 / (1.0 + std::numbers::sqrt2 * k + k * k);
    b_ = norm;
    a1_ = 2.0 * (k * k - 1.0) * norm;
    a2_ = (1.0 - std::numbers::sqrt2 * k + k * k) * norm;
  }
  Vector3d update(const Vector3d& x) {
    Vector3d y = b_ * (x - 2.0 * x1_ + x2_) - a1_ * y1_ - a2_ * y2_;
    x2_ = x1_;
    x1_ = x;
    y2_ = y1_;
    y1_ = y;
    return y;
  }

 private:
  double b_;
  double a1_;
  double a2_;
  Vector3d x1_ = Vector3d::Zero();
  Vector3d x2_ = Vector3d::Zero();
  Vector3d y1_ = Vector3d::Zero();
  Vector3d y2_ = Vector3d::Zero();
};

/// Path of a hand that descends onto the sheet within a second, then moves along it at the depth at
/// which it presses with kPress.
simulation::HandPath drawn_hand(const simulation::Setup& setup, double seconds) {
  const CosSheet sheet;
  const double deep = 1e-3 + kPress / setup.plant.hand.stiffness_N_m;
  std::vector<simulation::Waypoint> points;
  const auto at = [&](double s) {
    const double x = -0.02 + 0.9 * s;
    return std::pair{x, -0.012 + 0.4359 * s};
  };
  const auto [x0, y0] = at(0.0);
  points.push_back({0.0, sheet.point(x0, y0) + 0.004 * sheet.normal(x0, y0)});
  for (double t = 1.0; t <= seconds + 1.0; t += 0.02) {
    const auto [x, y] = at(kSpeed * (t - 1.0));
    points.push_back({t, sheet.point(x, y) - deep * sheet.normal(x, y)});
  }
  return simulation::HandPath(std::move(points));
}

double vibration(const Shape& shape, Mode mode, double seconds) {
  simulation::Setup setup;
  setup.controller.mode = render_mode(mode);
  setup.controller.contact.stiffness_N_m = 1000.0F;
  for (float& counts : setup.controller.device.counts_per_m) {
    counts = static_cast<float>(1.0 / kEncoderStep);
  }
  setup.board.encoders.counts_per_m = static_cast<double>(setup.controller.device.counts_per_m[0]);
  simulation::Simulation sim(shape.bytes(), setup, drawn_hand(setup, seconds));
  if (!sim.start_result().ok() || !sim.arm()) {
    throw std::runtime_error("the closed loop cannot start");
  }
  const double rate = static_cast<double>(setup.controller.rate_hz);
  HighPass filter(kCorner, rate);
  Errors acceleration;
  Vector3d last = Vector3d::Zero();
  for (double i = 0.0; i < (seconds + 1.0) * rate; i += 1.0) {
    sim.step();
    const Vector3d velocity = sim.plant().velocity_m_s();
    const Vector3d above = filter.update((velocity - last) * rate);
    last = velocity;
    if (i > 1.5 * rate) {  // touched down and settled
      acceleration.add(above.norm());
    }
  }
  return acceleration.rms();
}

// ---- stability

// The textbook case: a mass with viscous damping only, a constant push, an ideal sensor.
constexpr double kDamping = 0.5;  // Ns/m
constexpr double kPush = 0.5;     // N
constexpr double kGrid = 0.0;     // m, x and y of the probe; on a point, as paper mode requires

/// Releases a device at a distance from its equilibrium in the wall. Returns true if the
/// oscillation decays.
bool is_stable(const Shape& wall, Mode mode, double rate_hz, double stiffness) {
  core::Configuration configuration;
  configuration.mode = render_mode(mode);
  configuration.contact.stiffness_N_m = static_cast<float>(stiffness);
  configuration.contact.damping_Ns_m = 0.0F;
  core::Scene scene;
  add_at_rest(scene, wall.view());
  const double depth = kPush / stiffness;
  const Vector3d begin(kGrid, kGrid, -1.1 * depth);
  for (const double z : {5e-4, 1e-6, begin.z()}) {
    (void)scene.update(configuration, narrow({kGrid, kGrid, z}), {});
  }
  plant::PlantParameters parameters;
  parameters.device = {0.075, kDamping, 0.0};
  // The spring of the hand is so soft that its force is nearly constant.
  parameters.hand = {0.0, 1.0, 0.0};
  parameters.substep_s = 1e-6;  // the plant leads by half of it: 1 % of the hold's delay at 10 kHz
  plant::Plant device(parameters, begin);
  const plant::HandTarget push{{kGrid, kGrid, -kPush}, Vector3d::Zero()};
  const double ticks = 1.0 * rate_hz;
  double early = 0.0;
  double late = 0.0;
  for (double i = 0.0; i < ticks; i += 1.0) {
    const core::Rendering r = scene.update(configuration, narrow(device.position_m()), {}).contact;
    if (!r.in_contact) {
      return false;  // the device left the wall or passed through it
    }
    device.advance(widen(r.force), push, 1.0 / rate_hz);
    const double squared = device.velocity_m_s().squaredNorm();
    early += i < 0.2 * ticks ? squared : 0.0;
    late += i >= 0.8 * ticks ? squared : 0.0;
  }
  return late < early;
}

double largest_stable(const Shape& wall, Mode mode, double rate_hz, double expected) {
  double low = 0.1 * expected;
  double high = 4.0 * expected;
  for (int i = 0; i < 10; ++i) {  // to an accuracy of less than 1 %
    const double middle = std::sqrt(low * high);
    (is_stable(wall, mode, rate_hz, middle) ? low : high) = middle;
  }
  return low;
}

LoopResult::Limit measure_limit(double rate_hz, double delay_s, double hand_Ns_m,
                                double wall_Ns_m) {
  simulation::StabilityCase c;
  c.rate_hz = rate_hz;
  c.delay_s = delay_s;
  c.mass_kg = hand_Ns_m > 0.0 ? 0.175 : 0.1;
  c.device_damping_Ns_m = hand_Ns_m > 0.0 ? 0.1 : 0.5;
  c.hand_damping_Ns_m = hand_Ns_m;
  c.wall_damping_Ns_m = wall_Ns_m;
  // Well above the natural frequency of the wall, because a slower filter reduces the effect of the
  // wall's damping.
  c.velocity_cutoff_hz = std::max(c.velocity_cutoff_hz, rate_hz / 20.0);
  LoopResult::Limit limit{rate_hz, delay_s, hand_Ns_m, wall_Ns_m, 0.0, 0.0, 0.0};
  limit.formula_N_m = simulation::predicted_stiffness(c);
  limit.measured_N_m = simulation::largest_stable_stiffness(c);
  c.passivity_Ns_m = static_cast<double>(core::Configuration{}.passivity_Ns_m);
  limit.passive_N_m = simulation::largest_stable_stiffness(c);
  return limit;
}

}  // namespace

LoopResult measure_loop(bool quick) {
  LoopResult result;
  const Shape sheet = cos_sheet(CosSheet{}, 0.05, kCoarse);
  const Shape paper_sheet = sheet.paper_twin();
  const double seconds = quick ? 2.0 : 4.0;
  result.vibration_m_s2[kSurface] = vibration(sheet, kSurface, seconds);
  result.vibration_m_s2[kPaper] = vibration(paper_sheet, kPaper, seconds);

  Shape wall(kCoarse);
  add_sheet(wall, 0.02, 0.0, 1.0);
  wall.seal();
  const Shape paper_wall = wall.paper_twin();
  for (const double rate_hz : {1000.0, 4000.0, 10000.0}) {
    LoopResult::Stiffness row{rate_hz, 2.0 * kDamping * rate_hz, {}};
    row.max_N_m[kSurface] = largest_stable(wall, kSurface, rate_hz, row.expected_N_m);
    row.max_N_m[kPaper] = largest_stable(paper_wall, kPaper, rate_hz, row.expected_N_m);
    result.stiffness.push_back(row);
  }
  for (const double rate_hz : {1000.0, 4000.0, 10000.0}) {
    for (const double delay_s : {0.0, 0.3e-3}) {
      result.limits.push_back(measure_limit(rate_hz, delay_s, 1.0, 0.0));
      result.limits.push_back(measure_limit(rate_hz, delay_s, 0.0, 0.0));
    }
    result.limits.push_back(measure_limit(rate_hz, 0.0, 0.0, 1.0));
  }
  return result;
}

}  // namespace tactree::evaluation
